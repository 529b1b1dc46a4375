// Key frames on the page: views are added, played, and saved as a file for `aligngs render --path`.
import { duration, keyAt, pathText, readPath, stretched, type CameraKey } from './camera_path';
import { element, iconButton, kIcons, make } from './dom';
import { type Messages } from './messages';

const kBetween = 3;                    // seconds between a new key and the one before
const kLeast = 0.1, kMost = 3600;      // seconds of a path
const kDigits = 4;                     // of a coordinate in a file

export interface PathCamera {
  get(): Omit<CameraKey, 'time'>;      // where the camera is now, in the scene's own axes
  show(key: CameraKey): void;          // puts it there
  begin(): void;                       // it is no longer moved by hand
  end(key: CameraKey): void;           // it is again, from there
}

/// Gives a text or a picture to the user as a file.
export function offer(content: Blob, name: string): void {
  const link = make('a');
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  window.setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

export class PathPanel {
  keys: CameraKey[] = [];
  playing = false;
  private store = '';

  constructor(private camera: PathCamera, private messages: Messages) {
    element('path-add').addEventListener('click', () => this.add());
    element('path-play').addEventListener('click', () => this.toggle());
    element('path-save').addEventListener('click', () => offer(new Blob([pathText(this.keys)], { type: 'application/json' }), 'keys.json'));
    const file = element<HTMLInputElement>('path-file');
    element('path-open').addEventListener('click', () => file.click());
    file.addEventListener('change', () => void this.open(file));
    element('path-seconds').addEventListener('change', () => {
      const seconds = Number(element<HTMLInputElement>('path-seconds').value);
      if (seconds >= kLeast && seconds <= kMost) this.set(stretched(this.keys, seconds));
      else this.show();
    });
  }

  /// The path that this browser keeps for the run with this name.
  restore(run: string): void {
    const store = `aligngs-path:${run}`;
    if (this.store === store) return;
    this.store = store;
    try { this.keys = readPath(localStorage.getItem(store) ?? ''); } catch { this.keys = []; }
    this.show();
  }

  add(): void {
    const { eye, target, fov } = this.camera.get(), rounded = (v: number[]) => v.map((x) => Number(x.toFixed(kDigits)));
    const time = this.keys.length > 0 ? this.keys[this.keys.length - 1].time + kBetween : 0;
    this.set([...this.keys, { time, eye: rounded(eye), target: rounded(target), fov: Number(fov.toFixed(2)) }]);
  }

  toggle(): void {
    if (this.playing) { this.playing = false; return; }
    if (this.keys.length < 2) { this.messages.show('A path has two views or more. Add views first.'); return; }
    this.playing = true;
    this.camera.begin();
    this.show();
    const begun = performance.now(), keys = this.keys;
    const step = () => {
      const at = (performance.now() - begun) / 1000, key = keyAt(keys, keys[0].time + at);
      if (!this.playing || at >= duration(keys)) {
        this.playing = false;
        this.camera.end(key);
        this.show();
        return;
      }
      this.camera.show(key);
      requestAnimationFrame(step);
    };
    step();
  }

  private async open(input: HTMLInputElement): Promise<void> {
    const file = input.files?.[0];
    input.value = '';
    if (!file) return;
    try { this.set(readPath(await file.text())); } catch (e) { this.messages.error(e); }
  }

  private set(keys: CameraKey[]): void {
    this.playing = false;
    this.keys = keys;
    try { localStorage.setItem(this.store, pathText(keys)); } catch { /* it lasts as long as the page */ }
    this.show();
  }

  private show(): void {
    const { keys } = this;
    element('path-keys').replaceChildren(...keys.map((key, i) => {
      const row = make('li'), open = make('button', 'class-name', `${(key.time - keys[0].time).toFixed(1)} s`);
      open.addEventListener('click', () => this.camera.end(key));
      row.append(open, iconButton(kIcons.bin, 'remove', 'remove', `view ${i + 1} of the path`, () => this.set(keys.filter((k) => k !== key))));
      return row;
    }));
    element('path-file-row').hidden = keys.length === 0;
    element<HTMLInputElement>('path-seconds').value = duration(keys).toFixed(1);
    element<HTMLInputElement>('path-seconds').disabled = keys.length < 2;
    element('path-play').textContent = this.playing ? 'stop' : 'play';
    element<HTMLButtonElement>('path-play').disabled = keys.length < 2;
    element('path-save').hidden = keys.length === 0;
  }
}
