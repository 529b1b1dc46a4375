// Rays against the triangles of a mesh, through a grid of cells that is made when it is first asked.
import { type PlyMesh } from './mesh_ply';

const kTrianglesACell = 2;       // as many cells as half of the triangles
const kMostCells = 1 << 21;
const kLeastSide = 1e-6;         // scene units: a flat mesh has a box, too
const kParallel = 1e-12;         // determinant of a ray that does not cross a triangle

export interface MeshHit { triangle: number; distance: number } // the place of its first corner in the list of corners; scene units

export class MeshRays {
  private low = [0, 0, 0];
  private cell = 1;
  private counts = [1, 1, 1];
  private starts = new Uint32Array(2);  // of each cell in `listed`
  private listed = new Uint32Array(0);  // triangles, cell by cell

  constructor(private mesh: PlyMesh) { this.build(); }

  /// The nearest triangle along a ray; `direction` has the length 1. Triangles that `drawn` refuses let it through.
  first(origin: number[], direction: number[], drawn: (triangle: number) => boolean): MeshHit | null {
    const { low, cell, counts } = this, high = counts.map((n, k) => low[k] + n * cell);
    let begin = 0, end = Infinity;
    for (let k = 0; k < 3; ++k) {
      const a = (low[k] - origin[k]) / direction[k], b = (high[k] - origin[k]) / direction[k];
      if (direction[k] === 0) { if (origin[k] < low[k] || origin[k] > high[k]) return null; continue; }
      begin = Math.max(begin, Math.min(a, b));
      end = Math.min(end, Math.max(a, b));
    }
    if (begin > end) return null;
    // From cell to cell, as Amanatides and Woo (1987) do.
    const at = [0, 1, 2].map((k) => Math.max(0, Math.min(counts[k] - 1, Math.floor((origin[k] + begin * direction[k] - low[k]) / cell))));
    const step = direction.map((d) => (d > 0 ? 1 : -1)), delta = direction.map((d) => (d === 0 ? Infinity : cell / Math.abs(d)));
    const next = direction.map((d, k) => (d === 0 ? Infinity : (low[k] + (at[k] + (d > 0 ? 1 : 0)) * cell - origin[k]) / d));
    for (;;) {
      const leaves = Math.min(next[0], next[1], next[2]), found = this.inCell((at[2] * counts[1] + at[1]) * counts[0] + at[0], origin, direction, drawn);
      if (found && found.distance <= leaves + kLeastSide) return found; // farther ones may have a nearer one in the next cell
      const k = next.indexOf(leaves);
      at[k] += step[k];
      if (at[k] < 0 || at[k] >= counts[k]) return found;
      next[k] += delta[k];
    }
  }

  private inCell(cell: number, o: number[], d: number[], drawn: (triangle: number) => boolean): MeshHit | null {
    const { positions: p, indices } = this.mesh;
    let best: MeshHit | null = null;
    for (let n = this.starts[cell]; n < this.starts[cell + 1]; ++n) {
      const f = this.listed[n], a = 3 * indices[f], b = 3 * indices[f + 1], c = 3 * indices[f + 2];
      // Möller and Trumbore (1997), both sides.
      const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2], vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
      const hx = d[1] * vz - d[2] * vy, hy = d[2] * vx - d[0] * vz, hz = d[0] * vy - d[1] * vx, det = ux * hx + uy * hy + uz * hz;
      if (Math.abs(det) < kParallel) continue;
      const sx = o[0] - p[a], sy = o[1] - p[a + 1], sz = o[2] - p[a + 2], u = (sx * hx + sy * hy + sz * hz) / det;
      if (u < 0 || u > 1) continue;
      const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux, v = (d[0] * qx + d[1] * qy + d[2] * qz) / det;
      if (v < 0 || u + v > 1) continue;
      const distance = (vx * qx + vy * qy + vz * qz) / det;
      if (distance > 0 && (!best || distance < best.distance) && drawn(f)) best = { triangle: f, distance };
    }
    return best;
  }

  private build(): void {
    const { positions, indices } = this.mesh, low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const i of indices) for (let k = 0; k < 3; ++k) { low[k] = Math.min(low[k], positions[3 * i + k]); high[k] = Math.max(high[k], positions[3 * i + k]); }
    if (indices.length === 0) return;
    const sides = high.map((h, k) => Math.max(kLeastSide, h - low[k])), wanted = Math.min(kMostCells, Math.max(1, indices.length / 3 / kTrianglesACell));
    this.low = low;
    this.cell = Math.max(Math.cbrt((sides[0] * sides[1] * sides[2]) / wanted), Math.max(...sides) / wanted);
    this.counts = sides.map((s) => Math.max(1, Math.ceil(s / this.cell)));
    const total = this.counts[0] * this.counts[1] * this.counts[2], starts = new Uint32Array(total + 1);
    this.eachCell((cell) => { ++starts[cell + 1]; });
    for (let c = 0; c < total; ++c) starts[c + 1] += starts[c];
    const fill = starts.slice(), listed = new Uint32Array(starts[total]);
    this.eachCell((cell, triangle) => { listed[fill[cell]++] = triangle; });
    this.starts = starts;
    this.listed = listed;
  }

  /// Cells that the box of each triangle reaches into.
  private eachCell(visit: (cell: number, triangle: number) => void): void {
    const { positions, indices } = this.mesh, { low, cell, counts } = this;
    const place = (x: number, k: number) => Math.max(0, Math.min(counts[k] - 1, Math.floor((x - low[k]) / cell)));
    for (let f = 0; f < indices.length; f += 3) {
      const a = 3 * indices[f], b = 3 * indices[f + 1], c = 3 * indices[f + 2];
      const first = [0, 0, 0], last = [0, 0, 0];
      for (let k = 0; k < 3; ++k) {
        first[k] = place(Math.min(positions[a + k], positions[b + k], positions[c + k]), k);
        last[k] = place(Math.max(positions[a + k], positions[b + k], positions[c + k]), k);
      }
      for (let z = first[2]; z <= last[2]; ++z) for (let y = first[1]; y <= last[1]; ++y) for (let x = first[0]; x <= last[0]; ++x) visit((z * counts[1] + y) * counts[0] + x, f);
    }
  }
}
