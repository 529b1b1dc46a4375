// Brings the splats of a file to the viewer: the most visible ones first, then all, with a progress bar.
import { exportedColumns, exportedEdits, kExported } from './api';
import { firstOf, readColumns, unpacked, type Columns, type Head } from './columns';
import { element } from './dom';
import { download } from './download';
import { editedScene } from './edited_scene';

const address = (part: 'scene/coarse' | 'scene/rest' | 'edits/scene', path: string, version: string): string =>
  `/api/${part}/${path.split('/').map(encodeURIComponent).join('/')}?v=${encodeURIComponent(version)}`;

export class SceneLoader {
  private current = new AbortController();
  private trained: { key: string; columns: Columns } | null = null; // of an edited scene, which is made of it

  /// `shown` draws splats, and ends when they are to be seen; the second call has all of them. `steps` of a first scene: one picture as early as possible; a scene that takes
  /// the place of another comes at once. `edits` is the version of the edits that are to be seen, or null. A newer call ends an older one.
  async load(path: string, version: string, edits: string | null, steps: boolean, shown: (columns: Columns, first: boolean) => Promise<void>): Promise<void> {
    this.current.abort();
    const { signal } = this.current = new AbortController();
    if (kExported) {
      const columns = exportedColumns(), now = edits === null ? columns : await editedScene(columns, exportedEdits() as BlobPart);
      if (!signal.aborted) await shown(now, true);
      return;
    }
    const key = `${path}?${version}`;
    try {
      if (this.trained?.key === key) {
        const { columns } = this.trained, now = edits === null ? columns : await this.edited(columns, path, edits, signal);
        if (!signal.aborted) await shown(now, true);
        return;
      }
      this.trained = null;
      const coarse = await unpacked(await download(address('scene/coarse', path, version), (got, total) => this.progress('first picture', got, total), signal));
      const head = coarse.head as Head, columns = readColumns(head, coarse.bytes);
      const coming = download(address('scene/rest', path, version), (got, total) => this.progress('all details', got, total), signal);
      coming.catch(() => {}); // told when it is waited for
      // The first picture is to be seen before the work on the rest begins.
      if (steps && edits === null && head.shown < head.total) await shown(firstOf(columns, head.shown), true);
      const rest = await unpacked(await coming);
      if (signal.aborted) return;
      readColumns(rest.head as Head, rest.bytes, columns);
      this.trained = { key, columns };
      const now = edits === null ? columns : await this.edited(columns, path, edits, signal);
      if (!signal.aborted) await shown(now, !steps || edits !== null || head.shown >= head.total);
    } finally {
      if (!signal.aborted) element('loading').hidden = true;
    }
  }

  private async edited(trained: Columns, path: string, edits: string, signal: AbortSignal): Promise<Columns> {
    return editedScene(trained, await download(address('edits/scene', path, edits), () => {}, signal));
  }

  private progress(what: string, got: number, total: number): void {
    element('loading').hidden = false;
    element<HTMLProgressElement>('loading-bar').value = total > 0 ? got / total : 0;
    element('loading-text').textContent = `${what}: ${(got / 1e6).toFixed(1)} of ${(total / 1e6).toFixed(1)} MB`;
  }
}
