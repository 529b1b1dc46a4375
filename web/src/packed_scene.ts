// The scene inside an exported page (src/serve/html_export.h): columns of small numbers, gzip, base64.
import { readColumns, unpacked, type Columns, type Head } from './columns';

export async function unpackScene(base64: string): Promise<{ state: object; columns: Columns }> {
  const { head, bytes } = await unpacked(Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)));
  const { state, count, columns } = head as { state: object; count: number; columns: Head['columns'] };
  return { state, columns: readColumns({ total: count, shown: count, columns }, bytes) };
}
