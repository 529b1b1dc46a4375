// The page of `aligngs view`.
import { Vec3 } from 'playcanvas';
import { fetchState, fileUrl, listen, photoUrl, type CameraInfo, type RunState } from './api';
import { Charts } from './charts';
import { Orbit } from './orbit';
import { Viewer, type ClassStyle } from './viewer';

const element = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const kNoLabel = 65535;
// Drawn here: not every system has a font with an eye.
const kEye = '<svg viewBox="0 0 16 16" width="14" height="14"><path d="M1 8c3-5 11-5 14 0-3 5-11 5-14 0z" fill="none" stroke="currentColor" stroke-width="1.4"/><circle cx="8" cy="8" r="2" fill="currentColor"/></svg>';
const kSolo = '<svg viewBox="0 0 16 16" width="14" height="14"><circle cx="8" cy="8" r="6" fill="none" stroke="currentColor" stroke-width="1.4"/><circle cx="8" cy="8" r="2.5" fill="currentColor"/></svg>';

class Page {
  private state!: RunState;
  private styles: ClassStyle[] = [];
  private solo = -1;
  private comparing: CameraInfo | null = null;
  private ruler: Vec3[] | null = null;
  private frustaShown = false;
  private loadedVersion = '';
  private loading: Promise<void> | null = null;
  private orbit: Orbit;
  private charts = new Charts(element('charts'));

  constructor(private viewer: Viewer) {
    this.orbit = new Orbit(viewer.camera, viewer.canvas, () => viewer.draw(), (x, y) => this.clicked(x, y));
    this.bindControls();
  }

  async start(): Promise<void> {
    await this.refresh();
    this.startPose();
    listen({
      reset: () => this.charts.reset(),
      events: (events) => {
        this.charts.add(events);
        const last = events.filter((e) => e.losses).pop();
        if (last) element('progress').textContent = `step ${last.step}, ${last.gaussians?.toLocaleString('en')} Gaussians, ${last.psnr?.toFixed(2)} dB`;
        element('training').hidden = this.charts.points === 0;
      },
      state: () => void this.refresh().catch((e) => this.message(String(e))),
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
      if (s.splats && s.version !== this.loadedVersion) {
        this.message('loading the splats');
        this.viewer.setUp(this.up());
        const first = this.loadedVersion === '';
        await this.viewer.loadSplats(fileUrl(s.splats, s.version));
        this.loadedVersion = s.version;
        this.viewer.mesh = null;
        this.buildClasses();
        this.applyStyles();
        if (first) this.startPose();
        this.message('');
      } else if (!s.splats) this.message('no splats yet: they appear when the training writes them');
      element<HTMLButtonElement>('show-mesh').disabled = !s.mesh;
      this.fillViews();
    });
    return this.loading;
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
      list.append(row);
    }
    element('no-classes').hidden = list.childElementCount > 0;
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
    element('compare-box').hidden = !(this.state.cameras ?? []).length;
  }

  private showMode(mode: 'splats' | 'mesh'): void {
    const apply = () => {
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
    for (const kind of ['rgb', 'depth', 'normal', 'label', 'error']) if (kinds.includes(kind)) select.append(new Option(kind === 'rgb' ? 'render' : kind, kind));
    select.value = [...select.options].some((o) => o.value === before) ? before : '';
    element('compare').hidden = false;
    element('compare-controls').hidden = false;
    this.layoutCompare();
  }

  private layoutCompare(): void {
    const camera = this.comparing;
    if (!camera) return;
    const size = this.viewer.lookThrough(camera);
    const kind = element<HTMLSelectElement>('right').value, split = this.state.views[camera.img_name]?.split ?? 'test';
    const left = element<HTMLImageElement>('left-picture'), right = element<HTMLImageElement>('right-picture');
    for (const picture of [left, right]) { picture.style.width = `${size.width}px`; picture.style.height = `${size.height}px`; }
    const leftUrl = photoUrl(camera.img_name);
    if (!left.src.endsWith(leftUrl)) left.src = leftUrl;
    right.hidden = kind === '';
    if (kind) right.src = fileUrl(`renders/${split}/${kind}/${camera.img_name}.png`, this.state.version);
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
      if (!found) return;
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
    if (!found) { box.hidden = true; return; }
    const { hit } = found, info = this.state.classes?.find((c) => c.id === hit.label);
    const name = hit.label === kNoLabel ? 'no class' : info?.name ?? `class ${hit.label}`;
    const details = [hit.instance > 0 ? `object ${hit.instance}` : '', `${Math.round(100 * hit.share)} % of the ray`,
      hit.confidence > 0 ? `confidence ${hit.confidence.toFixed(2)}` : '', `${hit.distance.toFixed(2)} ${this.state.units === 'metres' ? 'm' : 'units'} away`];
    box.textContent = `${name}: ${details.filter(Boolean).join(', ')}`;
    box.hidden = false;
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
      const keys: Record<string, () => void> = {
        '1': () => this.showMode('splats'), '2': () => this.showMode('mesh'), m: () => this.toggleRuler(), c: () => this.toggleFrusta(),
        l: () => this.overlay(Number(element<HTMLInputElement>('overlay').value) > 0 ? 0 : 70), h: () => this.startPose(),
        n: () => this.nextView(1), p: () => this.nextView(-1), w: () => this.orbit.walk(0, 0, 1), s: () => this.orbit.walk(0, 0, -1),
        a: () => this.orbit.walk(-1, 0, 0), d: () => this.orbit.walk(1, 0, 0), q: () => this.orbit.walk(0, -1, 0), e: () => this.orbit.walk(0, 1, 0),
        '?': () => { element('help').hidden = !element('help').hidden; },
        Escape: () => { element('help').hidden = true; element('picked').hidden = true; if (this.ruler) this.toggleRuler(); else if (this.comparing) this.startPose(); },
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
