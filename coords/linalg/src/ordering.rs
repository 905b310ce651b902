//! Elimination orders.

use super::Pattern;
use super::graph::Graph;
use super::nested_dissection::{minimum_degree, nested_dissection};

/// How to choose an elimination order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Ordering {
    /// Approximate minimum degree (Amestoy, Davis and Duff, SIAM J. Matrix Anal. Appl. 17, 1996).
    MinimumDegree,
    /// Nested dissection (George, SIAM J. Numer. Anal. 10, 1973).
    NestedDissection,
    /// Minimum degree for small matrices; for large ones both, and the one that needs fewer operations.
    #[default]
    Best,
}

/// Number of groups from which nested dissection is tried. On isotropic squares it needs as many operations
/// as minimum degree at 4000 vertices, three quarters at 16 000 and two thirds at 65 000, and takes six times
/// as long to find.
const LARGE: usize = 4000;

/// An elimination order (`order[k]` is eliminated k-th) of a symmetric matrix given by its lower triangle,
/// whose unknowns come in groups of `block`, as the three coordinates of a vertex do. Groups stay together,
/// so the order is found on the graph of the groups, which has a ninth of the entries where `block` is three.
///
/// # Panics
/// If `block` does not divide the order of the matrix.
pub fn elimination_order(pattern: &Pattern, block: usize, ordering: Ordering) -> Vec<usize> {
    assert!(
        block > 0 && pattern.cols().is_multiple_of(block),
        "{} unknowns do not come in groups of {block}",
        pattern.cols()
    );
    let graph = Graph::of_blocks(pattern, block);
    let order = match ordering {
        Ordering::MinimumDegree => minimum_degree(&graph),
        Ordering::NestedDissection => nested_dissection(&graph),
        Ordering::Best => best(&graph, block),
    };
    postordered(&graph, &order)
        .iter()
        .flat_map(|v| (0..block).map(move |k| block * v + k))
        .collect()
}

fn best(graph: &Graph, block: usize) -> Vec<usize> {
    let degree = minimum_degree(graph);
    if graph.len() < LARGE {
        return degree;
    }
    let dissection = nested_dissection(graph);
    // Multiplications and additions of the numeric factorisation.
    let operations = |order| {
        column_counts(graph, order, block)
            .map(|c| c * c)
            .sum::<f64>()
    };
    if operations(&dissection) < operations(&degree) {
        dissection
    } else {
        degree
    }
}

/// The number of entries in each column of the Cholesky factor, the diagonal among them, without the zeros
/// that supernodes pad in, for groups of `block` unknowns that are each eliminated together.
fn column_counts(graph: &Graph, order: &[usize], block: usize) -> impl Iterator<Item = f64> {
    let below = EliminationTree::new(graph, order).below.into_iter();
    below.flat_map(move |rows| (1..=block).map(move |k| (rows * block + k) as f64))
}

/// The elimination tree of a graph in some order (Liu, "The role of elimination trees in sparse
/// factorization", SIAM J. Matrix Anal. Appl. 11, 1990).
struct EliminationTree {
    /// Parents, by places in the order; [`ROOT`] where there is none.
    parent: Vec<usize>,
    /// Number of rows of the factor below the diagonal, by columns.
    below: Vec<usize>,
}

const ROOT: usize = usize::MAX;

impl EliminationTree {
    /// Finds each row of the factor as the subtree that its entries hang on.
    fn new(graph: &Graph, order: &[usize]) -> Self {
        let n = graph.len();
        let mut place = vec![0; n];
        for (k, &v) in order.iter().enumerate() {
            place[v] = k;
        }
        let mut parent = vec![ROOT; n];
        let mut reached = vec![ROOT; n];
        let mut below = vec![0; n];
        for i in 0..n {
            reached[i] = i;
            for &w in graph.of(order[i] as u32) {
                let mut j = place[w as usize];
                if j > i {
                    continue;
                }
                while reached[j] != i {
                    if parent[j] == ROOT {
                        parent[j] = i;
                    }
                    reached[j] = i;
                    below[j] += 1;
                    j = parent[j];
                }
            }
        }
        Self { parent, below }
    }

    /// The places in the order, subtree by subtree, each root last.
    fn postorder(&self) -> Vec<usize> {
        let n = self.parent.len();
        let mut size = vec![1; n];
        let mut first = vec![0; n];
        let mut next_root = 0;
        for j in 0..n {
            if self.parent[j] != ROOT {
                size[self.parent[j]] += size[j];
            }
        }
        // From the roots down, each subtree takes its size from the room of the parent.
        for j in (0..n).rev() {
            let room = match self.parent[j] {
                ROOT => &mut next_root,
                parent => &mut first[parent],
            };
            let start = *room;
            *room += size[j];
            first[j] = start;
        }
        let mut list = vec![0; n];
        for j in 0..n {
            // What is left of the room of a vertex is its own place.
            list[first[j]] = j;
        }
        list
    }
}

/// An order with the same fill in which the subtrees of the elimination tree are ranges: the columns of a
/// supernode are adjacent then.
pub(super) fn postordered(graph: &Graph, order: &[usize]) -> Vec<usize> {
    let places = EliminationTree::new(graph, order).postorder();
    places.into_iter().map(|k| order[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a Cholesky factorisation costs.
    #[derive(Debug, PartialEq)]
    struct Fill {
        entries: f64,
        operations: f64,
    }

    /// The fill of a matrix in blocks of three, in an order that [`elimination_order`] returned.
    fn fill_of(pattern: &Pattern, order: &[usize]) -> Fill {
        let groups: Vec<usize> = order.iter().step_by(3).map(|i| i / 3).collect();
        let counts: Vec<f64> = column_counts(&Graph::of_blocks(pattern, 3), &groups, 3).collect();
        Fill {
            entries: counts.iter().sum(),
            operations: counts.iter().map(|c| c * c).sum(),
        }
    }

    /// The lower triangle of a matrix in blocks of three over the edges of a graph.
    fn blocks(vertices: u32, edges: &[(u32, u32)]) -> Pattern {
        let mut entries = Vec::new();
        for v in 0..vertices {
            for r in 0..3 {
                entries.extend((0..=r).map(|c| (3 * v + r, 3 * v + c)));
            }
        }
        for &(a, b) in edges {
            let (row, col) = (a.max(b), a.min(b));
            for r in 0..3 {
                entries.extend((0..3).map(|c| (3 * row + r, 3 * col + c)));
            }
        }
        let n = 3 * vertices as usize;
        Pattern::from_entries(n, n, &entries).0
    }

    fn of_sheet(sheet: &isosheet_mesh::Sheet) -> Pattern {
        let edges: Vec<(u32, u32)> = sheet
            .topology()
            .edges()
            .iter()
            .map(|[a, b]| (a.0, b.0))
            .collect();
        blocks(sheet.topology().vertex_count() as u32, &edges)
    }

    fn assert_permutation(order: &[usize], n: usize) {
        let mut sorted = order.to_vec();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..n));
    }

    const ALL: [Ordering; 3] = [
        Ordering::MinimumDegree,
        Ordering::NestedDissection,
        Ordering::Best,
    ];

    #[test]
    fn orders_are_permutations_of_whole_groups_and_repeat() {
        use isosheet_mesh::generate;
        let sheets = [
            generate::isotropic_square(0, 1.0).expect("valid"),
            generate::isotropic_square(4, 1.0).expect("valid"),
            generate::delaunay_square(1.0, 0.03, 1).expect("valid"),
            generate::annulus(60, 8, 0.3, 1.0).expect("valid"),
            generate::fan(500, 1.0, 3.0).expect("valid"),
        ];
        for sheet in &sheets {
            let pattern = of_sheet(sheet);
            for ordering in ALL {
                let order = elimination_order(&pattern, 3, ordering);
                assert_permutation(&order, pattern.cols());
                assert!(
                    order
                        .chunks(3)
                        .all(|g| g[0] % 3 == 0 && g[1] == g[0] + 1 && g[2] == g[0] + 2)
                );
                assert_eq!(order, elimination_order(&pattern, 3, ordering));
            }
        }
    }

    #[test]
    fn components_and_lone_vertices_are_ordered() {
        // Three strips of 300 links, numbered in turns, and five vertices without an edge.
        let mut edges = Vec::new();
        for k in 0..299 {
            for s in 0..3 {
                edges.push((3 * k + s, 3 * (k + 1) + s));
            }
        }
        let pattern = blocks(905, &edges);
        for ordering in ALL {
            let order = elimination_order(&pattern, 3, ordering);
            assert_permutation(&order, 3 * 905);
            // A strip needs no fill but next to separators: at most two rows below each block.
            let fill = fill_of(&pattern, &order);
            assert!(fill.entries <= 905.0 * 6.0 + 2.0 * 9.0 * 897.0, "{fill:?}");
        }
        assert!(elimination_order(&blocks(0, &[]), 3, Ordering::NestedDissection).is_empty());
    }

    #[test]
    fn a_complete_graph_has_no_separator() {
        let edges: Vec<(u32, u32)> = (0..150).flat_map(|v| (0..v).map(move |w| (v, w))).collect();
        let pattern = blocks(150, &edges);
        let order = elimination_order(&pattern, 3, Ordering::NestedDissection);
        assert_permutation(&order, 450);
        let fill = fill_of(&pattern, &order);
        assert_eq!(fill.entries, 450.0 * 451.0 / 2.0);
    }

    #[test]
    fn fill_is_counted_as_elimination_makes_it() {
        // Elimination played out on a dense Boolean matrix.
        let sheet = isosheet_mesh::generate::delaunay_square(1.0, 0.12, 3).expect("valid");
        let pattern = of_sheet(&sheet);
        let n = pattern.cols();
        for ordering in ALL {
            let order = elimination_order(&pattern, 3, ordering);
            let mut place = vec![0; n];
            for (k, &i) in order.iter().enumerate() {
                place[i] = k;
            }
            let mut full = vec![vec![false; n]; n];
            for c in 0..n {
                for &r in &pattern.row_idx()[pattern.col_ptr()[c]..pattern.col_ptr()[c + 1]] {
                    full[place[r]][place[c]] = true;
                    full[place[c]][place[r]] = true;
                }
            }
            let (mut entries, mut operations) = (0.0, 0.0);
            for k in 0..n {
                let rows: Vec<usize> = (k..n).filter(|&i| full[i][k]).collect();
                entries += rows.len() as f64;
                operations += (rows.len() as f64).powi(2);
                for &i in &rows {
                    for &j in &rows {
                        full[i][j] = true;
                    }
                }
            }
            let fill = fill_of(&pattern, &order);
            assert_eq!((fill.entries, fill.operations), (entries, operations));
        }
    }

    #[test]
    fn nested_dissection_is_worth_it_on_large_meshes() {
        use isosheet_mesh::generate;
        for (sheet, share) in [
            (generate::isotropic_square(6, 1.0).expect("valid"), 0.8),
            (
                generate::delaunay_square(1.0, 0.01, 1).expect("valid"),
                0.85,
            ),
            (generate::annulus(100, 60, 0.2, 1.0).expect("valid"), 0.9),
        ] {
            let pattern = of_sheet(&sheet);
            let fill = |o| fill_of(&pattern, &elimination_order(&pattern, 3, o));
            let degree = fill(Ordering::MinimumDegree);
            let dissection = fill(Ordering::NestedDissection);
            assert!(
                dissection.operations < share * degree.operations
                    && dissection.entries < degree.entries,
                "{degree:?} {dissection:?}"
            );
            assert_eq!(fill(Ordering::Best), dissection);
        }
    }

    #[test]
    fn fill_of_nested_dissection_grows_as_theory_says() {
        // O(V log V) entries and O(V^1.5) operations on planar meshes: with every level the entries per
        // vertex grow by the same amount.
        let fill = |level| {
            let sheet = isosheet_mesh::generate::isotropic_square(level, 1.0).expect("valid");
            let pattern = of_sheet(&sheet);
            let order = elimination_order(&pattern, 3, Ordering::NestedDissection);
            let vertices = sheet.topology().vertex_count() as f64;
            let fill = fill_of(&pattern, &order);
            (
                fill.entries / vertices,
                fill.operations / vertices.powf(1.5),
            )
        };
        let [f4, f5, f6] = [4, 5, 6].map(fill);
        assert!(f6.0 - f5.0 < 1.1 * (f5.0 - f4.0), "{f4:?} {f5:?} {f6:?}");
        assert!(f6.1 < 1.1 * f5.1, "{f5:?} {f6:?}");
    }
}
