// The page's parts and how they belong together.
import { Vec3 } from 'playcanvas';
import { editedMeshUrl, exportedMesh, fetchState, fileUrl, kExported, listen, type RunState } from './api';
import { ClassList } from './class_list';
import { Comparison } from './comparison';
import { element } from './dom';
import { ObjectDrag } from './drag';
import { EditPanel } from './edits';
import { joystick } from './joystick';
import { bindKeys, showKeys, type Key } from './keys';
import { lookedAt } from './looked_at';
import { Measures } from './measures';
import { Messages } from './messages';
import { Navigation, type Mode, type Pose } from './navigation';
import { NoteKeeper } from './notes';
import { ObjectList } from './object_list';
import { PathPanel } from './path_panel';
import { bindPicture } from './picture';
import { Plan } from './plan';
import { poseOf, SavedViews } from './saved_views';
import { SceneLoader } from './scene_loader';
import { objectsOf, type SceneObject } from './scene_objects';
import { Selection } from './selection';
import { bindTheme } from './theme';
import { TrainingPanel } from './training';
import { type Viewer } from './viewer';

const kFieldOfView = 62, kUprightFieldOfView = 80; // degrees, vertical; the second for a phone held upright
const kFlyDistance = 2.2;  // of an object's size, from where it is looked at

export class Page {
  private state!: RunState;
  private frustaShown = false;
  private showsOriginal = false;
  private mode: 'splats' | 'mesh' = 'splats';
  private loadedSplats = '';
  private loading: Promise<void> | null = null;
  private planned: Promise<void> = Promise.resolve(); // sizes of objects are known
  private home: Pose | null = null; // stays the same while more splats come
  readonly navigation: Navigation;
  private loader = new SceneLoader();
  readonly messages = new Messages();
  readonly training = new TrainingPanel(this.messages);
  readonly edits = new EditPanel(this.messages, () => this.refresh());
  readonly classes = new ClassList(() => this.applyStyles(), (edit) => void this.edits.apply(edit));
  readonly objects: ObjectList;
  readonly selection: Selection;
  readonly comparison: Comparison;
  readonly plan = new Plan((place) => this.goTo(place));
  readonly notes = new NoteKeeper(() => this.showNotes(), (e) => this.messages.error(e));
  readonly views: SavedViews;
  readonly measures: Measures;
  readonly path: PathPanel;
  readonly drag: ObjectDrag;

  constructor(private viewer: Viewer) {
    this.drag = new ObjectDrag(viewer, { // before the navigation, which hears the same pointers
      picked: () => (this.selection.name && !this.ruler && !this.comparison.camera ? { ...this.selection.picked!, name: this.selection.name } : null),
      cameras: () => this.state.cameras ?? [], metric: () => this.state.units === 'metres',
      apply: (edit) => this.edits.apply(edit), tell: (text) => this.messages.show(text, 'work'),
    });
    this.navigation = new Navigation(viewer.camera, viewer.canvas, () => viewer.moved(), (x, y) => this.clicked(x, y));
    this.comparison = new Comparison(viewer, () => { this.selection.clear(); this.navigation.enabled = false; }, () => this.startPose());
    this.objects = new ObjectList({
      fly: (o) => this.flyTo(o), remove: (o) => void this.edits.apply(`delete ${o.name} --fill`), point: (o) => this.selection.point(o),
      hide: (hidden) => viewer.hideObjects(hidden),
    });
    this.selection = new Selection(viewer, this.objects);
    this.measures = new Measures(viewer, this.notes, this.messages);
    this.views = new SavedViews(viewer, this.notes, () => this.navigation.pose, (pose) => this.look(pose.eye, pose.target), (text) => this.messages.show(text));
    this.path = new PathPanel({
      get: () => {
        const { eye, target } = this.navigation.pose;
        return { eye: viewer.fromWorld(eye, true), target: viewer.fromWorld(target, true), fov: viewer.camera.camera!.fov };
      },
      show: (key) => viewer.lookFrom(viewer.toWorld(key.eye), viewer.toWorld(key.target), key.fov),
      begin: () => { this.comparison.end(); this.selection.clear(); this.navigation.enabled = false; },
      end: (key) => { this.look(viewer.toWorld(key.eye), viewer.toWorld(key.target)); viewer.lookFrom(viewer.toWorld(key.eye), viewer.toWorld(key.target), key.fov); },
    }, this.messages);
    bindPicture(viewer, this.messages);
    viewer.moving = () => this.navigation.moving;
    viewer.onPose = () => { this.selection.hover(null); this.markPlan(); };
    this.bindControls();
  }

  async start(): Promise<void> {
    await this.refresh();
    listen({
      reset: () => this.training.reset(),
      events: (events) => this.training.events(events),
      state: () => void this.refresh().catch((e) => this.messages.error(e)),
      lost: () => this.setConnected(false),
      found: (restarted) => {
        this.setConnected(true);
        if (!restarted) return;
        this.messages.show('The server was started again. The page is connected to it.');
        void this.refresh().catch((e) => this.messages.error(e));
      },
    });
  }

  /// Without its server the page still shows the room; what needs the server waits.
  private setConnected(connected: boolean): void {
    document.body.classList.toggle('offline', !connected);
    element('offline').hidden = connected;
    if (connected) this.tellStatus();
    else element('status').textContent = 'no connection';
  }

  private tellStatus(): void {
    const s = this.state;
    element('status').textContent = [s.status, s.active && s.stage && s.stage !== s.status ? s.stage : ''].filter(Boolean).join(', ');
  }

  /// Reads the run's state, and its splats again when they changed.
  private refresh(): Promise<void> {
    this.loading = (this.loading ?? Promise.resolve()).catch(() => {}).then(async () => {
      this.state = await fetchState();
      const s = this.state;
      element('name').textContent = s.name;
      this.tellStatus();
      (element('report') as HTMLAnchorElement).hidden = !s.report;
      this.training.refresh(s);
      element('original').hidden = !s.edited;
      if (!s.edited) this.setOriginal(false);
      this.comparison.refresh(s);
      this.viewer.setUp(this.up());
      this.notes.open(s);
      this.path.restore(s.name);
      this.planned = this.plan.refresh(s.room, s.version).catch(() => {});
      await this.loadShown();
      element<HTMLButtonElement>('show-mesh').disabled = !s.mesh;
      if (s.problems.length > 0) this.messages.show(`The run has files that cannot be read: ${s.problems.join('; ')}.`, 'error');
      void this.edits.refresh(s);
    });
    return this.loading;
  }

  /// The splats that are to be seen now, and the mesh when it is.
  private async loadShown(): Promise<void> {
    const s = this.state, path = s.splats, edits = this.showsOriginal ? null : s.edits;
    if (!path && this.loadedSplats) return; // a training was stopped: its last splats stay
    if (!path) { this.messages.show('There are no splats yet. They appear when the training has some.', 'work'); return; }
    this.comparison.tellEdited(edits !== null);
    const wanted = `${path}?${s.version} ${edits}`;
    if (wanted === this.loadedSplats) return;
    const begins = this.loadedSplats === '';
    await this.loader.load(path, s.version, edits, begins, async (columns, first) => {
      this.viewer.setSplats(columns);
      this.loadedSplats = wanted;
      this.viewer.mesh = null;
      this.navigation.room = this.viewer.room;
      this.classes.build(this.viewer.splats?.labels ?? null, s);
      this.applyStyles();
      if (this.mode === 'mesh') this.showMode(s.mesh ? 'mesh' : 'splats');
      if (this.frustaShown) this.viewer.setFrusta(s.cameras ?? [], 0.25);
      if (begins && first) {
        this.messages.clear();
        this.startPose();
        const linked = poseOf(location.hash);
        if (linked) this.look(linked.eye, linked.target);
      }
      await this.listLater();
    });
  }

  private showNotes(): void {
    this.views.show();
    this.measures.show(this.state.units === 'metres');
  }

  /// Lists the objects after the next picture, which does not need them.
  private async listLater(): Promise<void> {
    const shown = this.viewer.splats;
    await Promise.all([this.planned, this.viewer.nextPicture()]);
    if (shown === this.viewer.splats) this.listObjects();
  }

  private listObjects(): void {
    const editable = this.state.editable && !this.showsOriginal, splats = this.viewer.splats;
    const objects = splats ? objectsOf(splats, this.state.classes ?? [], (p) => this.viewer.toWorld(p), this.plan.sizes) : [];
    this.selection.refresh(this.state, editable);
    this.objects.build(objects, this.state.units === 'metres', editable);
    this.selection.clear();
  }

  private setOriginal(on: boolean): void {
    this.showsOriginal = on && this.state.edited;
    element('original').setAttribute('aria-pressed', String(this.showsOriginal));
  }

  private toggleOriginal(): void {
    if (!this.state.edited) return;
    this.setOriginal(!this.showsOriginal);
    this.loading = (this.loading ?? Promise.resolve()).catch(() => {}).then(() => this.loadShown()).catch((e) => this.messages.error(e));
  }

  private up(): Vec3 {
    if (this.state.up) return new Vec3(...this.state.up);
    // Photos are held upright: the mean of the cameras' up directions.
    const sum = new Vec3(0, 0, 0);
    for (const c of this.state.cameras ?? []) sum.add(new Vec3(-c.rotation[0][1], -c.rotation[1][1], -c.rotation[2][1]));
    return sum.length() > 1e-6 ? sum.normalize() : new Vec3(0, -1, 0);
  }

  /// From the photo's place farthest from what the photos look at towards that.
  private startPose(): void {
    if (!this.home) {
      const seen = lookedAt(this.state.cameras ?? []), { room } = this.viewer;
      const target = seen && room ? room.inside(this.viewer.toWorld(seen), 0) : this.viewer.middle();
      let eye = target.clone().add(new Vec3(0, 1, 3)), farthest = 0;
      for (const c of this.state.cameras ?? []) {
        const p = this.viewer.toWorld(c.position), d = p.distance(target);
        if (d > farthest) { farthest = d; eye = p; }
      }
      this.home = { eye: room && farthest > 0 ? room.inside(eye, 0) : eye, target };
    }
    this.look(this.home.eye, this.home.target);
  }

  /// Leaves the place of a photo and looks from here.
  private look(eye: Vec3, target: Vec3): void {
    this.comparison.end();
    this.navigation.enabled = true;
    const { canvas } = this.viewer;
    this.viewer.camera.camera!.fov = canvas.clientWidth < canvas.clientHeight ? kUprightFieldOfView : kFieldOfView;
    this.navigation.lookFrom(eye, target);
  }

  /// Looks at an object from the middle of the room, or from above if it is there.
  private flyTo(object: SceneObject): void {
    const away = new Vec3().sub2(this.viewer.middle(), object.centre);
    away.y = Math.max(0.3 * away.length(), 0.3 * object.size.length());
    const distance = kFlyDistance * Math.max(0.2, object.size.length());
    const eye = object.centre.clone().add(away.normalize().mulScalar(distance));
    this.look(this.viewer.room ? this.viewer.room.inside(eye, 0.1) : eye, object.centre);
    this.selection.choose(object);
  }

  /// Goes to a place of the plan, as high as before.
  private goTo(place: (height: number) => number[]): void {
    const { eye, target } = this.navigation.pose, at = this.viewer.toWorld(place(0));
    const move = new Vec3(at.x - eye.x, 0, at.z - eye.z);
    this.setMode('walk');
    this.look(eye.clone().add(move), target.clone().add(move));
  }

  private markPlan(): void {
    const { eye, target } = this.navigation.pose;
    this.plan.mark(this.viewer.fromWorld(eye, true), this.viewer.fromWorld(target.sub(eye), false));
  }

  private setMode(mode: Mode): void {
    this.navigation.setMode(mode);
    element('walk').setAttribute('aria-pressed', String(mode === 'walk'));
    element('stick').hidden = mode !== 'walk';
  }

  private applyStyles(): void {
    this.viewer.setStyles(this.classes.styles, Number(element<HTMLInputElement>('overlay').value) / 100);
  }

  private showMode(mode: 'splats' | 'mesh'): void {
    const apply = () => {
      this.mode = mode;
      this.viewer.show(mode);
      for (const m of ['splats', 'mesh']) element('show-' + m).setAttribute('aria-pressed', String(m === mode));
    };
    if (mode === 'mesh' && !this.viewer.mesh && this.state.mesh) {
      this.messages.show('loading the mesh', 'work');
      const { mesh, version, edits } = this.state;
      const loaded = kExported ? exportedMesh(this.state.edited && this.showsOriginal).then((m) => this.viewer.setMesh(m))
        : this.viewer.loadMesh(edits && !this.showsOriginal ? editedMeshUrl(version + edits) : fileUrl(mesh, version));
      loaded.then(() => { this.messages.clear(); apply(); }, (e) => this.messages.error(e));
    } else if (mode === 'splats' || this.viewer.mesh) apply();
  }

  private clicked(x: number, y: number): void {
    const found = this.viewer.pick(x, y);
    if (this.measures.active) { this.measures.click(found?.point ?? null); return; }
    this.selection.pick(found);
  }

  private editPicked(verb: string): void {
    const object = this.selection.name;
    if (!object) return;
    this.selection.clear();
    const color = element<HTMLInputElement>('picked-color').value;
    void this.edits.apply(verb === 'recolor' ? `recolor ${object} to ${color}` : verb === 'delete' ? `delete ${object} --fill` : `${verb} ${object}`);
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
    on('measure', 'click', () => this.measures.toggle());
    on('frusta', 'click', () => this.toggleFrusta());
    on('home', 'click', () => this.startPose());
    on('walk', 'click', () => this.setMode(this.navigation.mode === 'walk' ? 'orbit' : 'walk'));
    on('plan-button', 'click', () => this.togglePlan());
    on('plan-close', 'click', () => this.togglePlan());
    joystick(element('stick'), (right, forward) => { this.navigation.stick = { right, forward }; this.navigation.run(); });
    this.viewer.canvas.addEventListener('pointermove', (e) => {
      if (e.pointerType === 'mouse' && e.buttons === 0 && !this.measures.active && !this.comparison.camera) this.selection.hover({ x: e.clientX, y: e.clientY });
      else if (e.buttons !== 0) this.selection.hover(null);
    });
    window.addEventListener('hashchange', () => { const pose = poseOf(location.hash); if (pose) this.look(pose.eye, pose.target); });
    bindTheme((dark) => { this.viewer.setBackground(dark); this.training.charts.recolor(); });
    on('original', 'click', () => this.toggleOriginal());
    on('picked-color', 'change', () => this.editPicked('recolor'));
    for (const button of document.querySelectorAll<HTMLElement>('#picked-edits button')) button.addEventListener('click', () => this.editPicked(button.dataset.edit!));
    on('reload', 'click', () => location.reload());
    on('help-button', 'click', () => showKeys(this.keys));
    on('help-close', 'click', () => element<HTMLDialogElement>('help').close());
    on('panel-button', 'click', () => this.openPanel(!document.body.classList.contains('panel-open')));
    bindKeys(this.keys);
  }

  private openPanel(open: boolean): void {
    document.body.classList.toggle('panel-open', open);
    element('panel-button').setAttribute('aria-expanded', String(open));
  }

  private togglePlan(): void {
    const box = element('plan');
    if (element('plan-button').hidden) return;
    box.hidden = !box.hidden;
    element('plan-button').setAttribute('aria-pressed', String(!box.hidden));
    this.markPlan();
  }

  private escape(): void {
    if (this.path.playing) this.path.toggle();
    else if (!element('plan').hidden) this.togglePlan();
    else if (this.measures.active) this.measures.toggle();
    else if (this.comparison.camera) this.startPose();
    else if (this.navigation.mode === 'walk') this.setMode('orbit');
    this.selection.clear();
  }

  private readonly keys: Key[] = [
    { keys: ['1', '2'], shown: '1, 2', does: 'splats, mesh', here: () => !!this.state.mesh, action: (key) => this.showMode(key === '1' ? 'splats' : 'mesh') },
    { keys: ['w', 'a', 's', 'd', 'q', 'e'], shown: 'w a s d q e', does: 'move', action: (key) => void this.navigation.press(key) },
    { keys: ['ArrowUp', 'ArrowDown', 'ArrowLeft', 'ArrowRight'], shown: 'arrows', does: 'forward, back, turn', action: (key) => void this.navigation.press(key) },
    { keys: [], shown: 'drag, shift + arrows', does: 'move the picked object over the floor', here: () => !!this.selection.name, action: () => {} },
    { keys: ['g'], shown: 'g', does: 'walk through the room, or turn it', action: () => this.setMode(this.navigation.mode === 'walk' ? 'orbit' : 'walk') },
    { keys: ['h'], shown: 'h', does: 'start pose', action: () => this.startPose() },
    { keys: ['f'], shown: 'f', does: 'floor plan', here: () => !!this.state.room, action: () => this.togglePlan() },
    { keys: ['l'], shown: 'l', does: 'label colours on or off', here: () => !!this.viewer.splats?.labels,
      action: () => this.overlay(Number(element<HTMLInputElement>('overlay').value) > 0 ? 0 : 70) },
    { keys: ['c'], shown: 'c', does: 'cameras', here: () => (this.state.cameras ?? []).length > 0, action: () => this.toggleFrusta() },
    { keys: ['m'], shown: 'm', does: 'measure', action: () => this.measures.toggle() },
    { keys: ['k'], shown: 'k', does: 'add the view to the camera path', action: () => this.path.add() },
    { keys: ['n', 'p'], shown: 'n, p', does: 'next, previous photo', here: () => !kExported && (this.state.cameras ?? []).length > 0,
      action: (key) => this.comparison.next(key === 'n' ? 1 : -1) },
    { keys: ['/'], shown: '/', does: 'type an edit', here: () => this.state.editable, action: () => { this.openPanel(true); element('edit-text').focus(); } },
    { keys: ['z', 'y'], shown: 'z, y', does: 'undo, redo', here: () => this.state.editable, action: (key) => void (key === 'z' ? this.edits.undo() : this.edits.redo()) },
    { keys: ['o'], shown: 'o', does: 'before the edits', here: () => this.state.edited, action: () => this.toggleOriginal() },
    { keys: [' '], shown: 'Space', does: 'pause the training, go on', here: () => this.state.active, action: () => void this.training.togglePause() },
    { keys: ['?'], shown: '?', does: 'this list', action: () => showKeys(this.keys) },
    { keys: ['Escape'], shown: 'Esc', does: 'leave', action: () => this.escape() },
  ];
}
