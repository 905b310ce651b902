// Edges of the triangles, and what the positions say about them.

/** A whole turn, radians. */
const TURN = 2 * Math.PI;

/** Edges in the order of isosheet_mesh::Topology: by smaller, then by larger vertex. */
export class Mesh {
  /**
   * @param {Uint32Array} faces corners, three for each face, counter-clockwise
   * @param {number} vertices number of vertices
   */
  constructor(faces, vertices) {
    this.faces = faces;
    this.vertexCount = vertices;
    this.faceCount = faces.length / 3;
    const sides = [];
    for (let k = 0; k < faces.length; k++) {
      const from = faces[k],
        to = faces[k - (k % 3) + ((k + 1) % 3)];
      const opposite = faces[k - (k % 3) + ((k + 2) % 3)];
      sides.push({
        key: Math.min(from, to) * vertices + Math.max(from, to),
        from,
        opposite,
        face: (k / 3) | 0,
        k,
      });
    }
    sides.sort((a, b) => a.key - b.key || a.k - b.k);
    const edges = [],
      hinges = [],
      edgeFaces = [];
    this.faceEdges = new Uint32Array(faces.length);
    for (let i = 0; i < sides.length; i++) {
      const side = sides[i],
        low = Math.floor(side.key / vertices),
        high = side.key % vertices;
      this.faceEdges[side.k] = edges.length / 2;
      edges.push(low, high);
      edgeFaces.push(side.face);
      const other = sides[i + 1];
      if (other?.key !== side.key) {
        hinges.push(-1, -1);
        continue;
      }
      // The left face of an edge is the one that runs along it from its smaller to its larger vertex.
      this.faceEdges[other.k] = edges.length / 2 - 1;
      const [left, right] = side.from === low ? [side, other] : [other, side];
      hinges.push(left.opposite, right.opposite);
      i++;
    }
    /** Two ends for each edge. */
    this.edges = Uint32Array.from(edges);
    /** The vertices opposite each edge in its left and right face, or -1, -1 on the boundary. */
    this.hinges = Int32Array.from(hinges);
    /** A face of each edge. */
    this.edgeFaces = Uint32Array.from(edgeFaces);
    this.edgeCount = edges.length / 2;
  }

  /**
   * Fold angles `now`, but for whole turns: at most half a turn from the one before, which `out` has. A fold
   * that is pressed through itself keeps its side.
   */
  followFolds(now, out) {
    for (let e = 0; e < this.edgeCount; e++) out[e] = now[e] + TURN * Math.round(((out[e] || 0) - now[e]) / TURN);
    return out;
  }

  /**
   * The fold angle of each edge, in radians within [-pi, pi]; zero when flat, NaN on the boundary, positive
   * for a valley as seen from the front: `atan2((nR x nL) . e, nL . nR)` with the unit vector e along the
   * edge.
   */
  foldAngles(x, out) {
    const { edges, hinges } = this;
    for (let e = 0; e < this.edgeCount; e++) {
      const left = 3 * hinges[2 * e],
        right = 3 * hinges[2 * e + 1];
      if (left < 0) {
        out[e] = NaN;
        continue;
      }
      const a = 3 * edges[2 * e],
        b = 3 * edges[2 * e + 1];
      const ex = x[b] - x[a],
        ey = x[b + 1] - x[a + 1],
        ez = x[b + 2] - x[a + 2];
      const lx = x[left] - x[a],
        ly = x[left + 1] - x[a + 1],
        lz = x[left + 2] - x[a + 2];
      const rx = x[right] - x[a],
        ry = x[right + 1] - x[a + 1],
        rz = x[right + 2] - x[a + 2];
      const nlx = ey * lz - ez * ly,
        nly = ez * lx - ex * lz,
        nlz = ex * ly - ey * lx;
      const nrx = ry * ez - rz * ey,
        nry = rz * ex - rx * ez,
        nrz = rx * ey - ry * ex;
      const sx = nry * nlz - nrz * nly,
        sy = nrz * nlx - nrx * nlz,
        sz = nrx * nly - nry * nlx;
      const sine = (sx * ex + sy * ey + sz * ez) / Math.hypot(ex, ey, ez);
      out[e] = Math.atan2(sine, nlx * nrx + nly * nry + nlz * nrz);
    }
    return out;
  }

  /** The mean length of the edges at positions `x`. */
  meanLength(x) {
    let sum = 0;
    for (let k = 0; k < this.edges.length; k += 2) {
      const a = 3 * this.edges[k],
        b = 3 * this.edges[k + 1];
      sum += Math.hypot(x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2]);
    }
    return sum / this.edgeCount;
  }
}
