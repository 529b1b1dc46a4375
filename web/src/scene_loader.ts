// Brings the splats of a file to the viewer: the most visible ones first, then all, with a progress bar.
import { exportedColumns, exportedEdits, kExported } from './api';
import { firstOf, readColumns, unpacked, type Columns, type Head } from './columns';
import { element } from './dom';
import { download } from './download';
import { editedScene } from './edited_scene';

const address = (part: 'scene/coarse' | 'scene/rest' | 'edits/scene', path: string, version: string): string =>
  `/api/${part}/${path.split('/').map(encodeURIComponent).join('/')}?v=${encodeURIComponent(version)}`;

const kSoon = 200; // milliseconds that the first splats wait for the others while a picture of the room is shown anyway

/// Whether a promise is kept within a time.
const isSoon = (coming: Promise<unknown>, milliseconds: number): Promise<boolean> =>
  Promise.race([coming.then(() => true, () => false), new Promise<boolean>((done) => window.setTimeout(() => done(false), milliseconds))]);

/// `first`: nothing of this scene was drawn before. `last`: these are all of its splats.
export interface Step { first: boolean; last: boolean }

export class SceneLoader {
  private current = new AbortController();
  private trained: { key: string; columns: Columns } | null = null; // of an edited scene, which is made of it

  /// `shown` draws splats, and ends when they are to be seen. `steps` of a first scene: one picture as early as possible. A
  /// scene that takes the place of another comes at once. `edits` is the version of the edits that are to be seen, or null. A newer call ends an older one.
  async load(path: string, version: string, edits: string | null, steps: boolean, shown: (columns: Columns, step: Step) => Promise<void>): Promise<void> {
    this.current.abort();
    const { signal } = this.current = new AbortController();
    if (kExported) {
      const columns = exportedColumns(), now = edits === null ? columns : await editedScene(columns, exportedEdits() as BlobPart);
      if (!signal.aborted) await shown(now, { first: true, last: true });
      return;
    }
    const key = `${path}?${version}`;
    try {
      if (this.trained?.key === key) {
        const { columns } = this.trained, now = edits === null ? columns : await this.edited(columns, path, edits, signal);
        if (!signal.aborted) await shown(now, { first: true, last: true });
        return;
      }
      this.trained = null;
      const coarse = await unpacked(await download(address('scene/coarse', path, version), (got, total) => this.progress('first picture', got, total), signal));
      const head = coarse.head as Head, columns = readColumns(head, coarse.bytes);
      // The server answers in turn: what the first picture needs is asked for first.
      const changes = edits === null ? null : download(address('edits/scene', path, edits), () => {}, signal);
      const coming = download(address('scene/rest', path, version), (got, total) => this.progress('all details', got, total), signal);
      for (const later of [changes, coming]) later?.catch(() => {}); // told when it is waited for
      const now = async (trained: Columns): Promise<Columns> => (changes ? editedScene(trained, await changes) : trained);
      // The first splats are to be seen before the work on the rest begins. They would hold it up where it is there at once.
      const before = steps && head.shown < head.total && !(this.hasPicture && await isSoon(coming, kSoon));
      if (before) await shown(await now(firstOf(columns, head.shown)), { first: true, last: false });
      const rest = await unpacked(await coming);
      if (signal.aborted) return;
      readColumns(rest.head as Head, rest.bytes, columns);
      this.trained = { key, columns };
      const all = await now(columns);
      if (!signal.aborted) await shown(all, { first: !before, last: true });
    } finally {
      if (!signal.aborted) element('loading').hidden = true;
    }
  }

  private async edited(trained: Columns, path: string, edits: string, signal: AbortSignal): Promise<Columns> {
    return editedScene(trained, await download(address('edits/scene', path, edits), () => {}, signal));
  }

  /// The server's picture of the start pose is shown.
  private get hasPicture(): boolean {
    const picture = element<HTMLImageElement>('first-picture');
    return !picture.hidden && picture.naturalWidth > 1;
  }

  private progress(what: string, got: number, total: number): void {
    element('loading').hidden = false;
    element<HTMLProgressElement>('loading-bar').value = total > 0 ? got / total : 0;
    element('loading-text').textContent = `${what}: ${(got / 1e6).toFixed(1)} of ${(total / 1e6).toFixed(1)} MB`;
  }
}
