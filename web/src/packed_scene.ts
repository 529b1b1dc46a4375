// The room inside an exported page (src/serve/html_export.h).
import { readColumns, unpacked, type Columns, type Head } from './columns';

/// The bytes of an element that holds base64; null where the page has no such element.
export function embeddedBytes(id: string): Uint8Array | null {
  const holder = document.getElementById(id);
  return holder && Uint8Array.from(atob(holder.textContent!.trim()), (c) => c.charCodeAt(0));
}

export async function unpackScene(gzip: BlobPart): Promise<{ state: object; room: unknown; columns: Columns }> {
  const { head, bytes } = await unpacked(gzip);
  const { state, room, count, columns } = head as { state: object; room: unknown; count: number; columns: Head['columns'] };
  return { state, room, columns: readColumns({ total: count, shown: count, columns }, bytes) };
}
