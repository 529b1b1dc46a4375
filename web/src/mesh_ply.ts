// Reads mesh/mesh.ply: binary little-endian, vertices with colours and labels, triangles.
import { request } from './api';

export interface PlyMesh { positions: Float32Array; colors: Uint8Array; labels: Uint16Array | null; indices: Uint32Array }

const kSizes: Record<string, number> = { char: 1, uchar: 1, short: 2, ushort: 2, int: 4, uint: 4, float: 4, double: 8 };

export async function fetchMesh(url: string): Promise<PlyMesh> {
  const answer = await request(url);
  if (!answer.ok) throw new Error(`The mesh cannot be loaded. The server answered ${answer.status}.`);
  return parseMeshPly(await answer.arrayBuffer());
}

export function parseMeshPly(buffer: ArrayBuffer): PlyMesh {
  const head = new TextDecoder('latin1').decode(new Uint8Array(buffer, 0, Math.min(buffer.byteLength, 8192)));
  const end = head.indexOf('end_header\n');
  if (!head.startsWith('ply') || end < 0 || !head.includes('format binary_little_endian')) throw new Error('not a binary PLY file');
  let vertices = 0, faces = 0, stride = 0, element = '';
  const at: Record<string, { offset: number; type: string }> = {};
  for (const line of head.slice(0, end).split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'element') {
      element = words[1];
      if (element === 'vertex') vertices = +words[2];
      if (element === 'face') faces = +words[2];
    } else if (words[0] === 'property' && element === 'vertex') {
      at[words[2]] = { offset: stride, type: words[1] };
      stride += kSizes[words[1]] ?? NaN;
    } else if (words[0] === 'property' && element === 'face' && line.trim() !== 'property list uchar int vertex_indices') {
      throw new Error('faces must be triangles');
    }
  }
  const view = new DataView(buffer), start = end + 'end_header\n'.length;
  if (!(stride > 0) || buffer.byteLength < start + vertices * stride + faces * 13) throw new Error('the file is cut off');
  const mesh: PlyMesh = {
    positions: new Float32Array(3 * vertices), colors: new Uint8Array(4 * vertices).fill(255),
    labels: at.label ? new Uint16Array(vertices) : null, indices: new Uint32Array(3 * faces),
  };
  for (let i = 0; i < vertices; ++i) {
    const o = start + i * stride;
    mesh.positions[3 * i] = view.getFloat32(o + at.x.offset, true);
    mesh.positions[3 * i + 1] = view.getFloat32(o + at.y.offset, true);
    mesh.positions[3 * i + 2] = view.getFloat32(o + at.z.offset, true);
    if (at.red) for (let k = 0; k < 3; ++k) mesh.colors[4 * i + k] = view.getUint8(o + at.red.offset + k);
    if (mesh.labels) mesh.labels[i] = view.getUint16(o + at.label.offset, true);
  }
  for (let f = 0, o = start + vertices * stride; f < faces; ++f, o += 13) {
    if (view.getUint8(o) !== 3) throw new Error('faces must be triangles');
    for (let k = 0; k < 3; ++k) mesh.indices[3 * f + k] = view.getUint32(o + 1 + 4 * k, true);
  }
  return mesh;
}
