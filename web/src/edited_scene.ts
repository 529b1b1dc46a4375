// The splats of an edited room, from those of the trained one and what its edits did (src/serve/edited_scene.h).
import { readColumns, unpacked, type Columns, type Head } from './columns';

interface EditHead { total: number; changed: number; added: number; changed_columns: Head['columns']; added_columns: Head['columns'] }

/// `bytes` is the gzip stream of the server. `trained` has all splats of the trained room, or the first ones (firstOf).
export async function editedScene(trained: Columns, bytes: BlobPart): Promise<Columns> {
  const part = await unpacked(bytes), head = part.head as EditHead, stays = Math.ceil(head.total / 8);
  const known = trained.count;
  if (head.total !== (trained.total ?? known)) throw new Error('The edits are of other splats than those that are shown.');
  const view = new DataView(part.bytes.buffer, part.bytes.byteOffset, part.bytes.byteLength);
  const rows: number[] = [];
  for (let k = 0; k < known; ++k) if (view.getUint8(k >> 3) & (1 << (k & 7))) rows.push(k);
  let at = stays;
  const place = new Int32Array(head.total).fill(-1); // of each trained splat in the new scene
  rows.forEach((row, i) => { place[row] = i; });
  const changed = Array.from({ length: head.changed }, (_, i) => place[view.getUint32(at + 4 * i, true)]);
  at += 4 * head.changed;
  const columnsOf = (columns: Head['columns'], count: number): Columns => {
    const read = readColumns({ total: count, shown: count, columns }, part.bytes.subarray(at));
    for (const { type } of columns) at += count * ({ f32: 4, i16: 2, u16: 2, i8: 1, u8: 1 })[type];
    return read;
  };
  const changes = columnsOf(head.changed_columns, head.changed), added = columnsOf(head.added_columns, head.added);
  const values = new Map<string, Float32Array>();
  for (const [name, old] of trained.values) {
    const out = new Float32Array(rows.length + head.added);
    for (let i = 0; i < rows.length; ++i) out[i] = old[rows[i]];
    const change = changes.values.get(name), more = added.values.get(name);
    if (change) changed.forEach((row, i) => { if (row >= 0) out[row] = change[i]; });
    if (more) out.set(more, rows.length);
    values.set(name, out);
  }
  const places = new Int32Array(rows.length + head.added), sources = part.bytes.length - 4 * head.added;
  places.set(rows);
  for (let i = 0; i < head.added; ++i) places[rows.length + i] = view.getInt32(sources + 4 * i, true); // -1: a copy, or it fills a hole
  return { count: rows.length + head.added, values, places, total: head.total };
}
