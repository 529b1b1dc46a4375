// A download that tells its progress and goes on where it was cut off.
import { request, refusal } from './api';

const kTries = 6, kPause = 1000; // times that it begins again without a byte in between, and milliseconds before each

/// `progress`: bytes that came, and bytes in all. Throws what the server refused in its words.
export async function download(url: string, progress: (got: number, total: number) => void, signal: AbortSignal): Promise<Blob> {
  let pieces: BlobPart[] = [], got = 0, etag = '', failures = 0;
  for (;;) {
    let refused = false;
    try {
      const answer = await request(url, { signal, headers: got > 0 ? { Range: `bytes=${got}-`, 'If-Range': etag } : {} });
      if (!answer.ok) { refused = true; throw await refusal(answer); }
      if (answer.status !== 206) { pieces = []; got = 0; } // from the beginning: the file is another one
      etag = answer.headers.get('ETag') ?? '';
      const total = got + Number(answer.headers.get('Content-Length')), reader = answer.body!.getReader();
      for (let part = await reader.read(); !part.done; part = await reader.read()) {
        pieces.push(part.value as BlobPart);
        got += part.value.length;
        failures = 0;
        progress(got, total);
      }
      if (got >= total) return new Blob(pieces);
      throw new Error('The download was cut off.');
    } catch (error) {
      if (refused || signal.aborted || ++failures >= kTries) throw error;
      await new Promise((resolve) => setTimeout(resolve, kPause));
    }
  }
}
