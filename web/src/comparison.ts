// At a photo's place: the photo on the left, the 3D view or a rendered map on the right, with a slider between them.
import { fileUrl, kExported, photoUrl, renderUrl, type CameraInfo, type RunState } from './api';
import { element } from './dom';
import { lookThrough } from './photo_camera';
import { type Viewer } from './viewer';

const kKinds = ['rgb', 'depth', 'normal', 'label', 'error'];

export class Comparison {
  camera: CameraInfo | null = null;
  private state!: RunState;

  /// `begun`, `left`: the free camera rests, and comes back to its start.
  constructor(private viewer: Viewer, private begun: () => void, private left: () => void) {
    element('view').addEventListener('change', () => this.choose(element<HTMLSelectElement>('view').value));
    element('right').addEventListener('change', () => this.layout());
    element('wipe').addEventListener('input', () => this.layout());
    element('leave').addEventListener('click', () => this.left());
    new ResizeObserver(() => this.layout()).observe(viewer.canvas);
  }

  /// The photos of the run.
  refresh(state: RunState): void {
    this.state = state;
    const select = element<HTMLSelectElement>('view'), before = select.value;
    select.replaceChildren(new Option('free camera', ''));
    for (const c of this.cameras) select.append(new Option(`${c.img_name}${c.split ? ` (${c.split})` : ''}`, c.img_name));
    select.value = before;
    element('compare-box').hidden = kExported || this.cameras.length === 0;
  }

  choose(name: string): void {
    const camera = this.cameras.find((c) => c.img_name === name);
    element<HTMLSelectElement>('view').value = camera ? name : '';
    if (!camera) { this.left(); return; }
    this.camera = camera;
    this.begun();
    const have = this.state.views[name]?.kinds ?? [], select = element<HTMLSelectElement>('right'), before = select.value;
    // The server draws the others where it can open the run.
    const made = this.state.drawable ? ['rgb', 'depth', 'normal', ...(this.state.classes ? ['label'] : [])] : [];
    select.replaceChildren(new Option('this view', ''));
    for (const kind of kKinds) if (have.includes(kind) || made.includes(kind)) select.append(new Option(kind === 'rgb' ? 'render' : kind, kind));
    select.value = [...select.options].some((o) => o.value === before) ? before : '';
    element('compare').hidden = false;
    element('compare-controls').hidden = false;
    this.layout();
  }

  /// Photos, and the pictures beside them, are of the room before its edits.
  tellEdited(edited: boolean): void { element('photo-before').hidden = !edited; }

  next(step: number): void {
    if (this.cameras.length === 0 || kExported) return;
    const at = this.camera ? this.cameras.indexOf(this.camera) : step > 0 ? -1 : 0;
    this.choose(this.cameras[(at + step + this.cameras.length) % this.cameras.length].img_name);
  }

  end(): void {
    if (!this.camera) return;
    this.camera = null;
    element('compare').hidden = true;
    element('compare-controls').hidden = true;
    element<HTMLSelectElement>('view').value = '';
  }

  private get cameras(): CameraInfo[] { return this.state.cameras ?? []; }

  private layout(): void {
    const camera = this.camera;
    if (!camera) return;
    const size = lookThrough(this.viewer, camera);
    const kind = element<HTMLSelectElement>('right').value, rendered = this.state.views[camera.img_name];
    const left = element<HTMLImageElement>('left-picture'), right = element<HTMLImageElement>('right-picture');
    for (const picture of [left, right]) { picture.style.width = `${size.width}px`; picture.style.height = `${size.height}px`; }
    const leftUrl = photoUrl(camera.img_name);
    if (!left.src.endsWith(leftUrl)) left.src = leftUrl;
    right.hidden = kind === '';
    const rightUrl = rendered?.kinds.includes(kind) ? fileUrl(`renders/${rendered.split}/${kind}/${camera.img_name}.png`, this.state.version)
      : renderUrl(camera.img_name, kind);
    if (kind && !right.src.endsWith(rightUrl)) right.src = rightUrl;
    const share = Number(element<HTMLInputElement>('wipe').value);
    left.style.clipPath = `inset(0 ${100 - share}% 0 0)`;
    right.style.clipPath = `inset(0 0 0 ${share}%)`;
  }
}
