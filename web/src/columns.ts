// The splats of a scene as columns of numbers: read from the compact form (src/serve/compact_scene.h) and from an exported
// page (src/serve/html_export.h).
interface Column {
  name: string; type: 'f32' | 'i16' | 'u16' | 'i8' | 'u8'; step: number;
  first?: number; count?: number; // splats that the column has; all without them
  log?: boolean;                  // the value is sign(v) ln(1 + |v|)
  delta?: boolean;                // numbers are differences from the one before, modulo 2^16
}
export interface Head { total: number; shown: number; columns: Column[] }
/// Values by name (x, f_dc_0, opacity, label, ...), one per splat. `places` of an edited scene: the number that a splat has
/// in the trained scene, -1 for new ones. `total`: splats of the trained scene, where these are not all of them.
export interface Columns { count: number; values: Map<string, Float32Array>; places?: Int32Array; total?: number }

const kBytes = { f32: 4, i16: 2, u16: 2, i8: 1, u8: 1 };

/// Expands a gzip stream and splits it after its first line, a JSON object.
export async function unpacked(compressed: BlobPart): Promise<{ head: unknown; bytes: Uint8Array }> {
  const stream = new Blob([compressed]).stream().pipeThrough(new DecompressionStream('gzip'));
  const all = new Uint8Array(await new Response(stream).arrayBuffer()), line = all.indexOf(10);
  return { head: JSON.parse(new TextDecoder().decode(all.subarray(0, line))), bytes: all.subarray(line + 1) };
}

/// Reads the columns of a part into `into`, or into new ones. Names that only a later part has are 0 until then.
export function readColumns(head: Head, bytes: Uint8Array, into: Columns = { count: head.total, values: new Map() }): Columns {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = 0;
  for (const column of head.columns) {
    const { type, step, first = 0, count = head.total } = column, size = kBytes[type];
    let values = into.values.get(column.name);
    if (!values) into.values.set(column.name, values = new Float32Array(head.total));
    let before = 0;
    for (let i = 0; i < count; ++i, at += size) {
      let number = type === 'f32' ? view.getFloat32(at, true) : type === 'i16' ? view.getInt16(at, true) : type === 'u16' ? view.getUint16(at, true)
        : type === 'i8' ? view.getInt8(at) : view.getUint8(at);
      if (column.delta) { before = (before + number) & 0xffff; number = type === 'i16' ? (before << 16) >> 16 : before; }
      const value = number * step;
      values[first + i] = column.log ? Math.sign(value) * Math.expm1(Math.abs(value)) : value;
    }
  }
  return into;
}

/// The first `count` splats alone.
export function firstOf(columns: Columns, count: number): Columns {
  return { count, values: new Map([...columns.values].map(([name, v]) => [name, v.slice(0, count)])), total: columns.count };
}
