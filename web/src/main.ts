// The page of `aligngs view`.
import { Vec3 } from 'playcanvas';
import { fetchState, fileUrl, kExported, listen, photoUrl, renderUrl, type CameraInfo, type RunState } from './api';
import { EditPanel } from './edits';
import { Orbit } from './orbit';
import { TrainingPanel } from './training';
import { Viewer, type ClassStyle } from './viewer';

const element = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const kNoLabel = 65535;
// Drawn here: not every system has a font with an eye.
const kEye = '<svg viewBox="0 0 16 16" width="14" height="14"><path d="M1 8c3-5 11-5 14 0-3 5-11 5-14 0z" fill="none" stroke="currentColor" stroke-width="1.4"/><circle cx="8" cy="8" r="2" fill="currentColor"/></svg>';
const kBrush = '<svg viewBox="0 0 16 16" width="14" height="14"><path d="M9 9 14 2M9 9c-3-1-5 1-5 3s-2 2-2 2c4 1 8-1 7-5z" fill="none" stroke="currentColor" stroke-width="1.4" stroke-linejoin="round"/></svg>';
const kSolo = '<svg viewBox="0 0 16 16" width="14" height="14"><circle cx="8" cy="8" r="6" fill="none" stroke="currentColor" stroke-width="1.4"/><circle cx="8" cy="8" r="2.5" fill="currentColor"/></svg>';

class Page {
  private state!: RunState;
  private styles: ClassStyle[] = [];
  private solo = -1;
  private comparing: CameraInfo | null = null;
  private ruler: Vec3[] | null = null;
  private frustaShown = false;
  private showsOriginal = false;
  private mode: 'splats' | 'mesh' = 'splats';
  private loadedSplats = '';
  private picked: string | null = null; // what the edit buttons mean
  private loading: Promise<void> | null = null;
  private orbit: Orbit;
  readonly training = new TrainingPanel((text) => this.message(text));
  readonly edits = new EditPanel((text) => this.message(text), () => this.refresh());

  constructor(private viewer: Viewer) {
    this.orbit = new Orbit(viewer.camera, viewer.canvas, () => viewer.draw(), (x, y) => this.clicked(x, y));
    this.bindControls();
  }

  async start(): Promise<void> {
    await this.refresh();
    if (!this.loadedSplats) this.startPose(); // otherwise loading them has done it
    listen({
      reset: () => this.training.reset(),
      events: (events) => this.training.events(events),
      state: () => void this.refresh().catch((e) => this.message(String(e))),
      lost: () => { element('status').textContent = 'no connection'; },
    });
  }

  /// Reads the run's state, and its splats again when they changed.
  private refresh(): Promise<void> {
    this.loading = (this.loading ?? Promise.resolve()).catch(() => {}).then(async () => {
      this.state = await fetchState();
      const s = this.state;
      element('name').textContent = s.name;
      element('status').textContent = [s.status, s.stage && s.stage !== s.status ? s.stage : ''].filter(Boolean).join(', ');
      (element('report') as HTMLAnchorElement).hidden = !s.report;
      this.training.refresh(s);
      element('original').hidden = !s.original;
      if (!s.original) this.setOriginal(false);
      await this.loadShown();
      element<HTMLButtonElement>('show-mesh').disabled = !s.mesh;
      this.fillViews();
      void this.edits.refresh(s);
    });
    return this.loading;
  }

  /// The splats that are to be seen now, and the mesh when it is.
  private async loadShown(): Promise<void> {
    const s = this.state, path = this.showsOriginal && s.original ? s.original : s.splats;
    if (!path) { this.message('no splats yet: they appear when there are some'); return; }
    const wanted = `${path}?${s.version}`;
    if (wanted === this.loadedSplats) return;
    const first = this.loadedSplats === '';
    if (first) this.message('loading the splats');
    this.viewer.setUp(this.up());
    await this.viewer.loadSplats(fileUrl(path, s.version));
    this.loadedSplats = wanted;
    this.viewer.mesh = null;
    this.buildClasses();
    this.applyStyles();
    if (this.mode === 'mesh') this.showMode(s.mesh && !this.showsOriginal ? 'mesh' : 'splats');
    if (this.frustaShown) this.viewer.setFrusta(s.cameras ?? [], 0.25);
    if (first) { this.startPose(); this.message(''); }
  }

  private setOriginal(on: boolean): void {
    this.showsOriginal = on && !!this.state.original;
    element('original').setAttribute('aria-pressed', String(this.showsOriginal));
  }

  private toggleOriginal(): void {
    if (!this.state.original) return;
    this.setOriginal(!this.showsOriginal);
    this.loading = (this.loading ?? Promise.resolve()).catch(() => {}).then(() => this.loadShown());
  }

  private up(): Vec3 {
    if (this.state.up) return new Vec3(...this.state.up);
    // Photos are held upright: the mean of the cameras' up directions.
    const sum = new Vec3(0, 0, 0);
    for (const c of this.state.cameras ?? []) sum.add(new Vec3(-c.rotation[0][1], -c.rotation[1][1], -c.rotation[2][1]));
    return sum.length() > 1e-6 ? sum.normalize() : new Vec3(0, -1, 0);
  }

  /// From the photo's place farthest from the middle of the room towards that middle.
  private startPose(): void {
    const middle = this.viewer.middle();
    let eye = middle.clone().add(new Vec3(0, 1, 3)), farthest = 0;
    for (const c of this.state.cameras ?? []) {
      const p = this.viewer.toWorld(c.position), d = p.distance(middle);
      if (d > farthest) { farthest = d; eye = p; }
    }
    this.endCompare();
    this.viewer.camera.camera!.fov = 62;
    this.orbit.lookFrom(eye, middle);
  }

  private message(text: string): void { element('message').textContent = text; }

  private buildClasses(): void {
    const labels = this.viewer.splats?.labels, counts = new Map<number, number>();
    if (labels) for (const l of labels) counts.set(l, (counts.get(l) ?? 0) + 1);
    const known = new Map((this.state.classes ?? []).map((c) => [c.id, c]));
    const list = element('classes');
    list.replaceChildren();
    for (const [id, count] of [...counts].sort((a, b) => b[1] - a[1])) {
      if (id === kNoLabel) continue;
      const info = known.get(id), color = info?.color ?? [128, 128, 128];
      this.styles[id] ??= { color: color as [number, number, number], visible: true };
      const row = document.createElement('li');
      row.dataset.label = String(id);
      const swatch = document.createElement('span');
      swatch.className = 'swatch';
      swatch.style.background = `rgb(${color.join(',')})`;
      const name = document.createElement('span');
      name.className = 'class-name';
      name.textContent = info?.name ?? `class ${id}`;
      name.title = info?.synonyms?.join(', ') ?? '';
      const number = document.createElement('span');
      number.className = 'count';
      number.textContent = count.toLocaleString('en');
      const button = (icon: string, title: string, action: () => void) => {
        const b = document.createElement('button');
        b.innerHTML = icon;
        b.title = title;
        b.setAttribute('aria-label', `${title}: ${name.textContent}`);
        b.onclick = action;
        return b;
      };
      const eye = button(kEye, 'show or hide', () => { this.solo = -1; this.styles[id].visible = !this.styles[id].visible; this.applyStyles(); });
      const solo = button(kSolo, 'show only this', () => {
        this.solo = this.solo === id ? -1 : id;
        this.styles.forEach((s, i) => { s.visible = this.solo < 0 || i === this.solo; });
        this.applyStyles();
      });
      eye.className = 'eye';
      solo.className = 'solo';
      row.append(swatch, name, number, eye, solo);
      if (this.state.editable && info) row.append(this.recolorButton(info.name));
      list.append(row);
    }
    element('no-classes').hidden = list.childElementCount > 0;
  }

  /// A colour that is chosen becomes an edit of the class.
  private recolorButton(name: string): HTMLElement {
    const label = document.createElement('label');
    label.className = 'recolor';
    label.title = 'recolour';
    label.innerHTML = kBrush;
    const color = document.createElement('input');
    color.type = 'color';
    color.value = '#add8e6';
    color.setAttribute('aria-label', `recolour: ${name}`);
    color.onchange = () => void this.edits.apply(`recolor ${name} to ${color.value}`);
    label.append(color);
    return label;
  }

  private applyStyles(): void {
    for (const row of element('classes').children) {
      const id = Number((row as HTMLElement).dataset.label);
      row.classList.toggle('hidden-class', !this.styles[id].visible);
      row.classList.toggle('solo-class', this.solo === id);
    }
    this.viewer.setStyles(this.styles, Number(element<HTMLInputElement>('overlay').value) / 100);
  }

  private fillViews(): void {
    const select = element<HTMLSelectElement>('view'), before = select.value;
    select.replaceChildren(new Option('free camera', ''));
    for (const c of this.state.cameras ?? []) select.append(new Option(`${c.img_name}${c.split ? ` (${c.split})` : ''}`, c.img_name));
    select.value = before;
    element('compare-box').hidden = kExported || !(this.state.cameras ?? []).length;
  }

  private showMode(mode: 'splats' | 'mesh'): void {
    const apply = () => {
      this.mode = mode;
      this.viewer.show(mode);
      for (const m of ['splats', 'mesh']) element('show-' + m).setAttribute('aria-pressed', String(m === mode));
    };
    if (mode === 'mesh' && !this.viewer.mesh && this.state.mesh) {
      this.message('loading the mesh');
      this.viewer.loadMesh(fileUrl(this.state.mesh, this.state.version)).then(() => { this.message(''); apply(); }, (e) => this.message(String(e)));
    } else if (mode === 'splats' || this.viewer.mesh) apply();
  }

  // Comparison at a photo's place: the photo on the left, the 3D view or a rendered map on the right.
  private compare(name: string): void {
    const camera = (this.state.cameras ?? []).find((c) => c.img_name === name);
    element<HTMLSelectElement>('view').value = camera ? name : '';
    if (!camera) { this.startPose(); return; }
    this.comparing = camera;
    element('picked').hidden = true;
    this.orbit.enabled = false;
    const kinds = this.state.views[name]?.kinds ?? [], select = element<HTMLSelectElement>('right'), before = select.value;
    select.replaceChildren(new Option('this view', ''));
    const made = this.state.active ? [] : ['rgb', 'depth', 'normal', ...(this.state.classes ? ['label'] : [])]; // the server draws them on demand
    for (const kind of ['rgb', 'depth', 'normal', 'label', 'error']) if (kinds.includes(kind) || made.includes(kind)) select.append(new Option(kind === 'rgb' ? 'render' : kind, kind));
    select.value = [...select.options].some((o) => o.value === before) ? before : '';
    element('compare').hidden = false;
    element('compare-controls').hidden = false;
    this.layoutCompare();
  }

  private layoutCompare(): void {
    const camera = this.comparing;
    if (!camera) return;
    const size = this.viewer.lookThrough(camera);
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

  private endCompare(): void {
    if (!this.comparing) return;
    this.comparing = null;
    this.orbit.enabled = true;
    element('compare').hidden = true;
    element('compare-controls').hidden = true;
    element<HTMLSelectElement>('view').value = '';
  }

  private nextView(step: number): void {
    const cameras = this.state.cameras ?? [];
    if (!cameras.length) return;
    const at = this.comparing ? cameras.indexOf(this.comparing) : step > 0 ? -1 : 0;
    this.compare(cameras[(at + step + cameras.length) % cameras.length].img_name);
  }

  private clicked(x: number, y: number): void {
    const found = this.viewer.pick(x, y);
    if (this.ruler) {
      if (!found) { this.message('nothing there to measure: click on a surface'); return; }
      if (this.ruler.length === 2) this.ruler = [];
      this.ruler.push(found.point);
      this.viewer.setRuler(this.ruler);
      if (this.ruler.length === 2) {
        const d = this.ruler[0].distance(this.ruler[1]);
        this.message(this.state.units === 'metres' ? `${d.toFixed(3)} m` : `${d.toFixed(3)} scene units`);
      } else this.message('click the second point');
      return;
    }
    const box = element('picked');
    this.picked = null;
    if (!found) { box.hidden = true; return; }
    const { hit } = found, info = this.state.classes?.find((c) => c.id === hit.label);
    const name = hit.label === kNoLabel ? 'no class' : info?.name ?? `class ${hit.label}`;
    const object = info && hit.instance > 0 ? `${info.name}#${hit.instance}` : null;
    const details = [hit.instance > 0 ? `object ${hit.instance}` : '', `${Math.round(100 * hit.share)} % of the ray`,
      hit.confidence > 0 ? `confidence ${hit.confidence.toFixed(2)}` : '', `${hit.distance.toFixed(2)} ${this.state.units === 'metres' ? 'm' : 'units'} away`];
    element('picked-text').textContent = `${name}: ${details.filter(Boolean).join(', ')}`;
    if (this.state.editable && info && !this.showsOriginal) this.picked = object ?? info.name;
    element('picked-edits').hidden = !this.picked;
    box.hidden = false;
  }

  private editPicked(verb: string): void {
    const object = this.picked;
    if (!object) return;
    element('picked').hidden = true;
    const color = element<HTMLInputElement>('picked-color').value;
    void this.edits.apply(verb === 'recolor' ? `recolor ${object} to ${color}` : verb === 'delete' ? `delete ${object} --fill` : `${verb} ${object}`);
  }

  private toggleRuler(): void {
    this.ruler = this.ruler ? null : [];
    element('measure').setAttribute('aria-pressed', String(!!this.ruler));
    this.viewer.setRuler([]);
    this.message(this.ruler ? 'click two points to measure' : '');
  }

  private toggleFrusta(): void {
    this.frustaShown = !this.frustaShown;
    element('frusta').setAttribute('aria-pressed', String(this.frustaShown));
    this.viewer.setFrusta(this.frustaShown ? this.state.cameras ?? [] : [], 0.25);
  }

  private overlay(value: number): void {
    element<HTMLInputElement>('overlay').value = String(Math.max(0, Math.min(100, value)));
    this.applyStyles();
  }

  private bindControls(): void {
    const on = (id: string, event: string, action: () => void) => element(id).addEventListener(event, action);
    on('show-splats', 'click', () => this.showMode('splats'));
    on('show-mesh', 'click', () => this.showMode('mesh'));
    on('overlay', 'input', () => this.applyStyles());
    on('measure', 'click', () => this.toggleRuler());
    on('frusta', 'click', () => this.toggleFrusta());
    on('home', 'click', () => this.startPose());
    on('original', 'click', () => this.toggleOriginal());
    on('picked-color', 'change', () => this.editPicked('recolor'));
    for (const button of document.querySelectorAll<HTMLElement>('#picked-edits button')) button.addEventListener('click', () => this.editPicked(button.dataset.edit!));
    on('all', 'click', () => { this.solo = -1; this.styles.forEach((s) => { s.visible = true; }); this.applyStyles(); });
    on('view', 'change', () => this.compare(element<HTMLSelectElement>('view').value));
    on('right', 'change', () => this.layoutCompare());
    on('wipe', 'input', () => this.layoutCompare());
    on('leave', 'click', () => this.startPose());
    on('help-button', 'click', () => { element('help').hidden = !element('help').hidden; });
    on('panel-button', 'click', () => { document.body.classList.toggle('panel-open'); });
    new ResizeObserver(() => this.layoutCompare()).observe(this.viewer.canvas);
    window.addEventListener('keydown', (e) => {
      if (e.ctrlKey || e.metaKey || e.altKey || e.target instanceof HTMLSelectElement) return;
      if (e.target instanceof HTMLInputElement && e.target.type === 'text') {
        if (e.key === 'Escape') e.target.blur();
        return;
      }
      if (e.key === ' ' && e.target instanceof HTMLButtonElement) return;
      const keys: Record<string, () => void> = {
        '1': () => this.showMode('splats'), '2': () => this.showMode('mesh'), m: () => this.toggleRuler(), c: () => this.toggleFrusta(),
        l: () => this.overlay(Number(element<HTMLInputElement>('overlay').value) > 0 ? 0 : 70), h: () => this.startPose(),
        n: () => this.nextView(1), p: () => this.nextView(-1), w: () => this.orbit.walk(0, 0, 1), s: () => this.orbit.walk(0, 0, -1),
        a: () => this.orbit.walk(-1, 0, 0), d: () => this.orbit.walk(1, 0, 0), q: () => this.orbit.walk(0, -1, 0), e: () => this.orbit.walk(0, 1, 0),
        z: () => void this.edits.undo(), y: () => void this.edits.redo(), o: () => this.toggleOriginal(), ' ': () => void this.training.togglePause(),
        '/': () => { document.body.classList.add('panel-open'); element('edit-text').focus(); },
        '?': () => { element('help').hidden = !element('help').hidden; },
        Escape: () => { element('help').hidden = true; element('picked').hidden = true; this.edits.closePreview(); if (this.ruler) this.toggleRuler(); else if (this.comparing) this.startPose(); },
      };
      const action = keys[e.key.length === 1 ? e.key.toLowerCase() : e.key];
      if (action) { e.preventDefault(); action(); }
    });
  }
}

async function main(): Promise<void> {
  try {
    const viewer = await Viewer.create(element<HTMLCanvasElement>('canvas'));
    const page = new Page(viewer);
    (window as unknown as Record<string, unknown>).aligngs = { viewer, page, ready: page.start().then(() => true) };
    await (window as unknown as { aligngs: { ready: Promise<boolean> } }).aligngs.ready;
  } catch (error) {
    element('message').textContent = `cannot show the scene: ${error instanceof Error ? error.message : String(error)}`;
    throw error;
  }
}

void main();
