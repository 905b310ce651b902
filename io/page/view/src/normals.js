// Normals of a sheet that is smooth where its faces meet at small angles, and has edges where they do not.

/** Faces at a vertex whose normals differ by less than this (cosine, 37 degrees) are a smooth surface there. */
const SMOOTH = 0.8;

export class Normals {
  constructor(mesh) {
    this.faces = mesh.faces;
    // The corners at each vertex: those from `first[v]` to `first[v + 1]` of the list.
    this.first = new Uint32Array(mesh.vertexCount + 1);
    for (const v of mesh.faces) this.first[v + 1]++;
    for (let v = 0; v < mesh.vertexCount; v++) this.first[v + 1] += this.first[v];
    const next = this.first.slice();
    this.corners = new Uint32Array(mesh.faces.length);
    mesh.faces.forEach((v, k) => (this.corners[next[v]++] = k));
    this.ofFaces = new Float64Array(mesh.faces.length);
  }

  /** Writes the unit normal of each corner of each face at positions `x`. */
  update(x, out) {
    const { faces, ofFaces, first, corners } = this;
    for (let k = 0; k < faces.length; k += 3) {
      const [a, b, c] = [3 * faces[k], 3 * faces[k + 1], 3 * faces[k + 2]];
      const ux = x[b] - x[a],
        uy = x[b + 1] - x[a + 1],
        uz = x[b + 2] - x[a + 2];
      const vx = x[c] - x[a],
        vy = x[c + 1] - x[a + 1],
        vz = x[c + 2] - x[a + 2];
      const nx = uy * vz - uz * vy,
        ny = uz * vx - ux * vz,
        nz = ux * vy - uy * vx;
      const length = Math.sqrt(nx * nx + ny * ny + nz * nz) || 1;
      ofFaces[k] = nx / length;
      ofFaces[k + 1] = ny / length;
      ofFaces[k + 2] = nz / length;
    }
    for (let v = 0; v + 1 < first.length; v++) {
      for (let i = first[v]; i < first[v + 1]; i++) {
        const own = corners[i] - (corners[i] % 3);
        const [nx, ny, nz] = [ofFaces[own], ofFaces[own + 1], ofFaces[own + 2]];
        let sx = 0,
          sy = 0,
          sz = 0;
        for (let j = first[v]; j < first[v + 1]; j++) {
          const other = corners[j] - (corners[j] % 3);
          const [ox, oy, oz] = [ofFaces[other], ofFaces[other + 1], ofFaces[other + 2]];
          if (nx * ox + ny * oy + nz * oz > SMOOTH) {
            sx += ox;
            sy += oy;
            sz += oz;
          }
        }
        const length = Math.sqrt(sx * sx + sy * sy + sz * sz) || 1,
          at = 3 * corners[i];
        out[at] = sx / length;
        out[at + 1] = sy / length;
        out[at + 2] = sz / length;
      }
    }
  }
}
