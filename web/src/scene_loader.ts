// Brings the splats of a file to the viewer: the most visible ones first, then all, with a progress bar.
import { exportedColumns, kExported } from './api';
import { firstOf, readColumns, unpacked, type Columns, type Head } from './columns';
import { element } from './dom';
import { download } from './download';

const address = (part: 'coarse' | 'rest', path: string, version: string): string =>
  `/api/scene/${part}/${path.split('/').map(encodeURIComponent).join('/')}?v=${encodeURIComponent(version)}`;

export class SceneLoader {
  private current = new AbortController();

  /// `shown` draws splats; the second call has all of them. `steps` of a first scene: one picture as early as possible; a scene that takes
  /// the place of another comes at once. A newer call ends an older one.
  async load(path: string, version: string, steps: boolean, shown: (columns: Columns, first: boolean) => void): Promise<void> {
    this.current.abort();
    const { signal } = this.current = new AbortController();
    if (kExported) { shown(await exportedColumns(), true); return; }
    try {
      const coarse = await unpacked(await download(address('coarse', path, version), (got, total) => this.progress('first picture', got, total), signal));
      const head = coarse.head as Head, columns = readColumns(head, coarse.bytes);
      if (steps && head.shown < head.total) shown(firstOf(columns, head.shown), true);
      const rest = await unpacked(await download(address('rest', path, version), (got, total) => this.progress('all details', got, total), signal));
      if (signal.aborted) return;
      shown(readColumns(rest.head as Head, rest.bytes, columns), !steps || head.shown >= head.total);
    } finally {
      if (!signal.aborted) element('loading').hidden = true;
    }
  }

  private progress(what: string, got: number, total: number): void {
    element('loading').hidden = false;
    element<HTMLProgressElement>('loading-bar').value = total > 0 ? got / total : 0;
    element('loading-text').textContent = `${what}: ${(got / 1e6).toFixed(1)} of ${(total / 1e6).toFixed(1)} MB`;
  }
}
