//! Small files that stand for much: what is named, used, compressed, nested or crossed many times.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use rand::{Rng, RngExt};
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// One file of each kind that a target reads, of random sizes.
pub(crate) fn of(target: &str, rng: &mut impl Rng) -> Vec<Vec<u8>> {
    let mut size = |most: u32| 2_usize.pow(rng.random_range(2..=most)) + rng.random_range(0..4);
    let texts = match target {
        "svg" => vec![
            entities(size(9), size(12)),
            entities_in_entities(size(4), size(3)),
            used_paths(size(14), size(12)),
            used_groups(size(3), size(3)),
            nested(size(13)),
            namespaces(size(10)),
            attributes(size(12)),
            selectors(size(5), size(6)),
            rules(size(10), size(10)),
            declarations(size(11), size(11)),
            names(size(13), size(10)),
            circles(size(5)),
            svg(&lines(size(8), "stroke='black'")),
            svg(&lines(size(8), "stroke='red'")),
        ],
        "dxf" => vec![dxf(size(8))],
        "cp" => vec![
            grid(size(9)),
            star(size(12)),
            parallels(size(13)),
            nested_squares(size(11)),
        ],
        "opx" => vec![opx(size(9)), nested(size(13))],
        "fold" => vec![fold_fan(size(10)), "[".repeat(size(14))],
        "obj" => vec![obj_fan(size(13)), obj_polygon(size(12))],
        "vtp" => vec![zlib(size(11), size(20)), pieces(size(10), size(13))],
        "trajectory" => return vec![archive(size(22))],
        _ => Vec::new(),
    };
    texts.into_iter().map(String::into_bytes).collect()
}

fn svg(inside: &str) -> String {
    format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>{inside}</svg>")
}

fn entities(length: usize, count: usize) -> String {
    let (value, named) = ("M0 0L1 1 ".repeat(length), "&a;".repeat(count));
    let path = format!("<path stroke='black' d='{named}'/>");
    format!("<!DOCTYPE svg [<!ENTITY a '{value}'>]>{}", svg(&path))
}

fn entities_in_entities(count: usize, depth: usize) -> String {
    let inner = |k: usize| format!("&e{};", k - 1).repeat(count);
    let defined = (1..=depth).map(|k| format!("<!ENTITY e{k} '{}'>", inner(k)));
    let defined: String = defined.collect();
    let path = format!("<path stroke='red' d='&e{depth};'/>");
    format!(
        "<!DOCTYPE svg [<!ENTITY e0 'M0 0h9'>{defined}]>{}",
        svg(&path)
    )
}

fn used_paths(curves: usize, uses: usize) -> String {
    let path = format!(
        "<path id='p' stroke='black' d='M0 0{}'/>",
        "h1v1".repeat(curves)
    );
    svg(&(path + &"<use href='#p'/>".repeat(uses)))
}

fn used_groups(uses: usize, depth: usize) -> String {
    let inner = |k: usize| format!("<use href='#g{}'/>", k - 1).repeat(uses);
    let groups = (1..=depth).map(|k| format!("<g id='g{k}'>{}</g>", inner(k)));
    svg(&("<path id='g0' d='M0 0h9'/>".to_owned() + &groups.collect::<String>()))
}

fn nested(depth: usize) -> String {
    svg(&("<g>".repeat(depth) + &"</g>".repeat(depth)))
}

fn namespaces(count: usize) -> String {
    let open = (0..count).map(|k| format!("<g xmlns:n{k}='u{k}'>"));
    svg(&(open.collect::<String>() + &"</g>".repeat(count)))
}

fn attributes(count: usize) -> String {
    let all = (0..count).map(|k| format!(" a{k}=''"));
    svg(&format!("<path{}/>", all.collect::<String>()))
}

fn selectors(parts: usize, depth: usize) -> String {
    let style = format!("<style>x {} {{ stroke: red }}</style>", "* ".repeat(parts));
    svg(&(style + &"<g>".repeat(depth) + &"</g>".repeat(depth)))
}

fn rules(rules: usize, elements: usize) -> String {
    let rules = (0..rules).map(|k| format!("g path{{opacity:0.{k}}}"));
    let style = format!("<style>{}</style>", rules.collect::<String>());
    svg(&format!(
        "{style}<g>{}</g>",
        "<path d='M0 0h1'/>".repeat(elements)
    ))
}

fn declarations(selectors: usize, declarations: usize) -> String {
    let (list, block) = (".a,".repeat(selectors), "a:b;".repeat(declarations));
    svg(&format!(
        "<style>{list}.a{{{block}}}</style><path class='a'/>"
    ))
}

fn names(length: usize, lines: usize) -> String {
    let line = |k: usize| format!("<path id='{k}' stroke='#{k:06x}' d='M0 0h9'/>");
    let lines = (0..lines).map(line).collect::<String>();
    svg(&format!("<g id='{}'>{lines}</g>", "n".repeat(length)))
}

fn circles(count: usize) -> String {
    let circle = |k: usize| format!("<circle cx='50' cy='50' r='{k}' stroke='black'/>");
    svg(&(1..count).map(circle).collect::<String>())
}

fn lines(count: usize, style: &str) -> String {
    let line = |k: usize| format!("<path {style} d='M0 {k}H{count}M{k} 0V{count}'/>");
    (0..=count).map(line).collect()
}

fn dxf(count: usize) -> String {
    let line = |ends: [usize; 4]| {
        let values = ["10", "20", "11", "21"].iter().zip(ends);
        let values = values.map(|(code, value)| format!("{code}\n{value}\n"));
        format!("0\nLINE\n8\n0\n{}", values.collect::<String>())
    };
    let both = |k| line([0, k, count, k]) + &line([k, 0, k, count]);
    let lines: String = (0..=count).map(both).collect();
    format!("0\nSECTION\n2\nENTITIES\n{lines}0\nENDSEC\n0\nEOF\n")
}

fn frame(size: usize) -> String {
    format!("1 0 0 {size} 0\n1 {size} 0 {size} {size}\n1 {size} {size} 0 {size}\n1 0 {size} 0 0\n")
}

fn grid(count: usize) -> String {
    let both = |k| format!("2 0 {k} {count} {k}\n3 {k} 0 {k} {count}\n");
    frame(count) + &(1..count).map(both).collect::<String>()
}

/// Lines from one point.
fn star(count: usize) -> String {
    let line = |k| format!("2 0 0 {count} {k}\n");
    frame(count) + &(1..count).map(line).collect::<String>()
}

/// Lines aslant beside each other, which lead nowhere.
fn parallels(count: usize) -> String {
    let line = |k| format!("1 {k} 0.5 {} {}\n", k + 3 * count, 2 * count);
    frame(4 * count) + &(1..count).map(line).collect::<String>()
}

fn nested_squares(count: usize) -> String {
    let square = |k: usize| {
        let (a, b) = (k, 2 * count - k);
        format!("2 {a} {a} {b} {a}\n2 {b} {a} {b} {b}\n2 {b} {b} {a} {b}\n2 {a} {b} {a} {a}\n")
    };
    (0..count).map(square).collect()
}

fn opx(count: usize) -> String {
    let property =
        |name, value| format!("<void property=\"{name}\"><double>{value}</double></void>");
    let line = |[a, b, c, d]: [usize; 4]| {
        let places = [("x0", a), ("y0", b), ("x1", c), ("y1", d)];
        let places = places.map(|(name, value)| property(name, value)).concat();
        format!("<object class=\"OriLineProxy\">{places}</object>")
    };
    let both = |k| line([0, k, count, k]) + &line([k, 0, k, count]);
    format!("<java>{}</java>", (0..=count).map(both).collect::<String>())
}

/// Edges without faces from one vertex to all others.
fn fold_fan(count: usize) -> String {
    let points = (0..count).map(|k| format!("[{k},{}]", k * k));
    let edges = (1..count).map(|k| format!("[0,{k}],[{},{k}]", k - 1));
    let (points, edges) = (points.collect::<Vec<_>>(), edges.collect::<Vec<_>>());
    let (points, edges) = (points.join(","), edges.join(","));
    format!("{{\"vertices_coords\":[{points}],\"edges_vertices\":[{edges}]}}")
}

/// Faces that all have an edge in common.
fn obj_fan(count: usize) -> String {
    let face = |k| format!("v {k} 1 0\nf 1 2 {}\n", k + 3);
    "v 0 0 0\nv 1 0 0\n".to_owned() + &(0..count).map(face).collect::<String>()
}

/// One face of many corners, a spiral.
fn obj_polygon(count: usize) -> String {
    let place = |k: usize, width: f64| {
        let angle = 0.1 * k as f64;
        let (sin, cos) = (angle.sin() * (angle + width), angle.cos() * (angle + width));
        format!("v {cos} {sin} 0\n")
    };
    let there = (0..count).map(|k| place(k, 9.0));
    let back = (0..count).rev().map(|k| place(k, 12.0));
    let corners = (1..=2 * count).map(|k| format!(" {k}"));
    let points = there.chain(back).collect::<String>();
    format!("{points}f{}\n", corners.collect::<String>())
}

fn polygons(points: &str, form: &str) -> String {
    format!(
        "<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><Points><DataArray type=\"Float64\" {form}>{points}</DataArray>\
         </Points></Piece>"
    )
}

/// A block of zeros that is named often.
fn zlib(count: usize, length: usize) -> String {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder
        .write_all(&vec![0; length])
        .expect("memory suffices");
    let block = encoder.finish().expect("memory suffices");
    let numbers = [vec![count, length, 0], vec![block.len(); count]].concat();
    let head: Vec<u8> = numbers
        .iter()
        .flat_map(|n| (*n as u64).to_le_bytes())
        .collect();
    let points = STANDARD.encode(head) + &STANDARD.encode(block.repeat(count));
    format!(
        "<VTKFile type=\"PolyData\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"><PolyData>{}</PolyData></VTKFile>",
        polygons(&points, "format=\"binary\"")
    )
}

/// Many pieces whose points are one and the same part of the file.
fn pieces(count: usize, length: usize) -> String {
    let pieces = polygons("", "format=\"appended\" offset=\"0\"").repeat(count);
    let data = [
        (8 * length as u64).to_le_bytes().to_vec(),
        vec![0; 8 * length],
    ]
    .concat();
    format!(
        "<VTKFile type=\"PolyData\" header_type=\"UInt64\"><PolyData>{pieces}</PolyData>\
         <AppendedData encoding=\"base64\">_{}</AppendedData></VTKFile>",
        STANDARD.encode(data)
    )
}

/// An archive of zeros.
fn archive(entries: usize) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    zip.start_file("t.npy", options).expect("a new archive");
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({entries},), }}");
    let length = (header.len() as u16).to_le_bytes();
    let array = [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes()].concat();
    zip.write_all(&array).expect("memory suffices");
    zip.write_all(&vec![0; 8 * entries])
        .expect("memory suffices");
    zip.finish().expect("memory suffices").into_inner()
}
