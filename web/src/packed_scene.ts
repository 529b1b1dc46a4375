// The scene inside an exported page (src/serve/html_export.h): columns of small numbers, gzip, base64.
interface Column { name: string; type: 'f32' | 'i16' | 'u16' | 'i8' | 'u8'; step: number }
interface Head { state: object; count: number; columns: Column[] }

const kTypes = {
  f32: { bytes: 4, ply: 'float', read: (v: DataView, at: number) => v.getFloat32(at, true) },
  i16: { bytes: 2, ply: 'float', read: (v: DataView, at: number) => v.getInt16(at, true) },
  u16: { bytes: 2, ply: 'ushort', read: (v: DataView, at: number) => v.getUint16(at, true) },
  i8: { bytes: 1, ply: 'float', read: (v: DataView, at: number) => v.getInt8(at) },
  u8: { bytes: 1, ply: 'uchar', read: (v: DataView, at: number) => v.getUint8(at) },
};

export async function unpackScene(base64: string): Promise<{ state: object; ply: ArrayBuffer }> {
  const compressed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([compressed]).stream().pipeThrough(new DecompressionStream('gzip'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const line = bytes.indexOf(10);
  const head: Head = JSON.parse(new TextDecoder().decode(bytes.subarray(0, line)));
  return { state: head.state, ply: plyOf(head, bytes, line + 1) };
}

/// A PLY file as every reader knows it.
function plyOf(head: Head, bytes: Uint8Array, start: number): ArrayBuffer {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), n = head.count;
  const size = { float: 4, ushort: 2, uchar: 1 } as Record<string, number>;
  const header = new TextEncoder().encode([
    'ply', 'format binary_little_endian 1.0', `element vertex ${n}`,
    ...head.columns.map((c) => `property ${kTypes[c.type].ply} ${c.name}`), 'end_header', ''].join('\n'));
  const row = head.columns.reduce((sum, c) => sum + size[kTypes[c.type].ply], 0);
  const ply = new ArrayBuffer(header.length + n * row), out = new DataView(ply);
  new Uint8Array(ply).set(header);
  let at = start, offset = header.length;
  for (const column of head.columns) {
    const type = kTypes[column.type];
    for (let i = 0; i < n; ++i, at += type.bytes) {
      const value = type.read(view, at) * column.step, to = offset + i * row;
      if (type.ply === 'float') out.setFloat32(to, value, true);
      else if (type.ply === 'ushort') out.setUint16(to, value, true);
      else out.setUint8(to, value);
    }
    offset += size[type.ply];
  }
  return ply;
}
