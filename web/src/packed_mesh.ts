// Reads the mesh of an exported page (src/serve/packed_mesh.h).
import { unpacked } from './columns';
import { type PlyMesh } from './mesh_ply';

interface MeshHead { vertices: number; triangles: number; low: number[]; step: number; colors: boolean; labels: boolean }
const kNoLabel = 65535;

export async function unpackMesh(gzip: BlobPart): Promise<PlyMesh> {
  const { head, bytes } = await unpacked(gzip), { vertices: n, triangles, low, step, colors, labels } = head as MeshHead;
  let at = 0;
  /// Numbers whose bytes lie in planes.
  const numbers = (count: number, planes: number): Uint32Array => {
    const out = new Uint32Array(count);
    for (let plane = 0; plane < planes; ++plane) for (let i = 0; i < count; ++i) out[i] |= bytes[at++] << (8 * plane);
    return out;
  };
  /// Numbers that are stored as differences.
  const sums = (planes: number): Int32Array => {
    const out = new Int32Array(n), codes = numbers(n, planes);
    for (let i = 0, value = 0; i < n; ++i) out[i] = value += codes[i] & 1 ? -(codes[i] >> 1) - 1 : codes[i] >> 1;
    return out;
  };
  const mesh: PlyMesh = { positions: new Float32Array(3 * n), colors: new Uint8Array(4 * n).fill(255), labels: labels ? new Uint16Array(n) : null, indices: new Uint32Array(3 * triangles) };
  for (let k = 0; k < 3; ++k) sums(2).forEach((v, i) => { mesh.positions[3 * i + k] = low[k] + step * v; });
  if (colors) for (let k = 0; k < 3; ++k) sums(1).forEach((v, i) => { mesh.colors[4 * i + k] = v & 255; });
  if (mesh.labels) sums(2).forEach((v, i) => { mesh.labels![i] = v === 0 ? kNoLabel : v - 1; });
  let next = 0;
  numbers(3 * triangles, 4).forEach((code, i) => {
    const v = mesh.indices[i] = next - code;
    if (v >= next) next = v + 1;
  });
  return mesh;
}
