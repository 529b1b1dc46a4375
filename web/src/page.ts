// The page's parts and how they belong together.
import { Vec3 } from 'playcanvas';
import { editedMeshUrl, exportedMesh, fetchState, fileUrl, kExported, listen, type RunState } from './api';
import { ClassList } from './class_list';
import { Comparison } from './comparison';
import { CutBox } from './cut_box';
import { tellConnected, tellStatus } from './connection';
import { element } from './dom';
import { ObjectDrag } from './drag';
import { EditPanel } from './edits';
import { HandSelection } from './hand_selection';
import { type Key } from './keys';
import { Measures } from './measures';
import { Messages } from './messages';
import { Navigation } from './navigation';
import { NoteKeeper } from './notes';
import { ObjectList } from './object_list';
import { bindControls } from './page_controls';
import { pageKeys } from './page_keys';
import { pathCamera } from './path_camera';
import { PathPanel } from './path_panel';
import { bindPicture } from './picture';
import { Places } from './places';
import { Plan } from './plan';
import { SavedViews } from './saved_views';
import { SceneLoader } from './scene_loader';
import { objectsOf } from './scene_objects';
import { Selection } from './selection';
import { upOf } from './start_pose';
import { TrainingPanel } from './training';
import { type Viewer } from './viewer';

const kListTime = 400; // milliseconds that the list waits for the other splats

export class Page {
  state!: RunState;
  private frustaShown = false;
  private showsOriginal = false;
  private mode: 'splats' | 'mesh' = 'splats';
  private loadedSplats = '';
  private loading: Promise<void> | null = null;
  private planned: Promise<void> = Promise.resolve(); // sizes of objects are known
  readonly navigation: Navigation;
  private loader = new SceneLoader();
  readonly messages = new Messages();
  readonly training = new TrainingPanel(this.messages);
  readonly edits = new EditPanel(this.messages, () => this.refresh());
  readonly classes = new ClassList(() => this.applyStyles(), (edit) => void this.edits.apply(edit));
  readonly objects: ObjectList;
  readonly selection: Selection;
  readonly hand: HandSelection;
  readonly comparison: Comparison;
  readonly plan = new Plan((place) => this.places.goTo(place));
  readonly notes = new NoteKeeper(() => this.showNotes(), (e) => this.messages.error(e));
  readonly cut = new CutBox(() => this.applyCut());
  readonly views: SavedViews;
  readonly measures: Measures;
  readonly path: PathPanel;
  readonly drag: ObjectDrag;
  readonly places = new Places(this);
  readonly keys: Key[] = pageKeys(this);

  constructor(readonly viewer: Viewer) {
    this.drag = new ObjectDrag(viewer, { // before the navigation, which hears the same pointers
      picked: () => this.draggable(),
      cameras: () => this.state.cameras ?? [], metres: () => this.metres,
      apply: (edit) => this.edits.apply(edit), tell: (text) => this.messages.show(text, 'work'),
    });
    this.navigation = new Navigation(viewer.camera, viewer.canvas, () => viewer.moved(), (x, y) => this.clicked(x, y));
    this.comparison = new Comparison(viewer, () => { this.selection.clear(); this.navigation.enabled = false; }, () => this.places.start());
    this.objects = new ObjectList({
      fly: (o) => this.places.flyTo(o), remove: (o) => void this.edits.apply(`delete ${o.name} --fill`), point: (o) => this.selection.point(o),
      hide: (hidden) => viewer.hideObjects(hidden),
    });
    this.measures = new Measures(viewer, this.notes, this.messages, () => this.refresh());
    this.hand = new HandSelection(viewer, this.messages, {
      state: () => this.state, opened: () => this.selection.clear(), picked: (name, splats) => this.selection.chooseNamed(name, splats),
    });
    this.selection = new Selection(viewer, this.objects, () => { if (!this.hand.open) this.hand.clear(); });
    this.views = new SavedViews(viewer, this.notes, () => this.navigation.pose, (pose) => this.places.look(pose.eye, pose.target), this.cut, (text) => this.messages.show(text));
    this.path = new PathPanel(pathCamera(this), this.messages);
    bindPicture(viewer, this.messages);
    viewer.moving = () => this.navigation.moving;
    viewer.onFirstSplats = () => this.dropFirstPicture();
    viewer.onPose = () => { this.selection.hover(null); this.places.markPlan(); };
    bindControls(this);
  }

  async start(): Promise<void> {
    await this.refresh();
    listen({
      reset: () => this.training.reset(),
      events: (events) => this.training.events(events),
      state: () => void this.refresh().catch((e) => this.messages.error(e)),
      lost: () => tellConnected(false, this.state),
      found: (restarted) => {
        tellConnected(true, this.state);
        if (!restarted) return;
        this.messages.show('The server was started again. The page is connected to it.');
        void this.refresh().catch((e) => this.messages.error(e));
      },
    });
  }

  /// Reads the run's state, and its splats again when they changed.
  private refresh(): Promise<void> {
    this.loading = (this.loading ?? Promise.resolve()).catch(() => {}).then(async () => {
      this.state = await fetchState();
      const s = this.state;
      element('name').textContent = s.name;
      tellStatus(s);
      (element('report') as HTMLAnchorElement).hidden = !s.report;
      this.training.refresh(s);
      element('original').hidden = !s.edited;
      if (!s.edited) this.setOriginal(false);
      this.comparison.refresh(s);
      this.viewer.setUp(s.up ? new Vec3(...s.up) : upOf(s.cameras ?? []));
      this.notes.open(s);
      this.path.restore(s.name);
      const followed = s.edited && s.editable; // the plan has the edits
      this.planned = this.plan.refresh(s.room, `${s.room_version ?? s.version}${followed ? s.edits : ''}`, followed).then((other) => { if (other) this.showScale(); }).catch(() => {});
      await this.loadShown();
      element<HTMLButtonElement>('show-mesh').disabled = !s.mesh;
      if (s.problems.length > 0) this.messages.show(`The run has files that cannot be read: ${s.problems.join('; ')}.`, 'error');
      void this.edits.refresh(s);
      void this.hand.refresh(s, s.editable);
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
    await this.loader.load(path, s.version, edits, begins, async (columns, { first, last }) => {
      this.viewer.setSplats(columns);
      this.loadedSplats = wanted;
      this.viewer.mesh = null;
      this.navigation.room = this.viewer.room;
      this.classes.build(this.viewer.splats?.labels ?? null, s);
      this.applyCut();
      this.applyStyles();
      if (this.mode === 'mesh') this.showMode(s.mesh ? 'mesh' : 'splats');
      if (this.frustaShown) this.viewer.setFrusta(s.cameras ?? [], 0.25);
      if (begins && first) {
        this.messages.clear();
        this.places.start();
        this.places.followLink();
      }
      await this.listLater(last);
    }).catch((e) => { this.dropFirstPicture(); throw e; });
  }

  /// The server's picture of the start pose (src/serve/start_picture.h) is shown until the splats are drawn.
  private dropFirstPicture(): void { element('first-picture').hidden = true; }

  /// The picked object, where a drag over it moves it: walls, the floor and what hangs on walls turn the view instead.
  private draggable(): { label: number; instance: number; name: string } | null {
    const { name, picked } = this.selection;
    if (!name || !picked || picked.instance === 0 || this.measures.active || this.hand.drawing || this.comparison.camera) return null;
    return this.viewer.style(picked.label).shell || /^floor/.test(name) ? null : { ...picked, name };
  }

  /// Metres of a scene unit; null: nothing tells the scale.
  private get metres(): number | null { return this.plan.metres ?? (this.state.units === 'metres' ? 1 : null); }
  private get estimated(): boolean { return this.plan.metres !== null ? this.plan.estimated : this.state.units === 'metres' && this.state.units_estimated; }
  private get canScale(): boolean { return !kExported && this.state.room !== null && !this.state.active; }

  /// Another scale: lengths read anew.
  private showScale(): void {
    this.showNotes();
    if (this.loadedSplats) this.listObjects();
  }

  private showNotes(): void {
    this.views.show();
    this.measures.show({ metres: this.metres, estimated: this.estimated, scalable: this.canScale, given: this.plan.given });
    for (const note of document.querySelectorAll<HTMLElement>('.estimate')) note.hidden = !this.estimated;
  }

  /// Lists the objects after the next picture, which does not need them. Those of the first splats are listed where the
  /// others take long.
  private async listLater(all: boolean): Promise<void> {
    const shown = this.viewer.splats, list = () => { if (shown === this.viewer.splats) this.listObjects(); };
    await Promise.all([this.planned, this.viewer.nextPicture()]);
    if (all) list(); else window.setTimeout(list, kListTime);
  }

  private listObjects(): void {
    const editable = this.state.editable && !this.showsOriginal, splats = this.viewer.splats;
    const objects = splats ? objectsOf(splats, this.state.classes ?? [], (p) => this.viewer.toWorld(p), this.plan.sizes) : [];
    this.selection.refresh(this.state, editable);
    this.objects.build(objects, this.metres, editable);
    this.selection.clear();
    this.hand.mark();
  }

  private setOriginal(on: boolean): void {
    this.showsOriginal = on && this.state.edited;
    element('original').setAttribute('aria-pressed', String(this.showsOriginal));
  }

  toggleOriginal(): void {
    if (!this.state.edited) return;
    this.setOriginal(!this.showsOriginal);
    this.loading = (this.loading ?? Promise.resolve()).catch(() => {}).then(() => this.loadShown()).catch((e) => this.messages.error(e));
  }

  applyCut(): void { this.viewer.cutTo(this.cut.bounds(this.viewer.room), this.cut.lines(this.viewer.room)); }
  applyStyles(): void {
    this.viewer.setStyles(this.classes.styles, Number(element<HTMLInputElement>('overlay').value) / 100);
  }

  showMode(mode: 'splats' | 'mesh'): void {
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

  toggleFrusta(): void {
    this.frustaShown = !this.frustaShown;
    element('frusta').setAttribute('aria-pressed', String(this.frustaShown));
    this.viewer.setFrusta(this.frustaShown ? this.state.cameras ?? [] : [], 0.25);
  }

  overlay(value: number): void {
    element<HTMLInputElement>('overlay').value = String(Math.max(0, Math.min(100, value)));
    this.applyStyles();
  }

  openPanel(open: boolean): void {
    document.body.classList.toggle('panel-open', open);
    element('panel-button').setAttribute('aria-expanded', String(open));
  }

  togglePlan(): void {
    const box = element('plan');
    if (element('plan-button').hidden) return;
    box.hidden = !box.hidden;
    element('plan-button').setAttribute('aria-pressed', String(!box.hidden));
    this.places.markPlan();
  }

  escape(): void {
    if (this.path.playing) this.path.toggle();
    else if (!element('plan').hidden) this.togglePlan();
    else if (this.measures.active) this.measures.toggle();
    else if (this.hand.open) { this.hand.escape(); if (this.hand.open) return; }
    else if (this.comparison.camera) this.places.start();
    else if (this.navigation.mode === 'walk') this.places.setMode('orbit');
    this.selection.clear();
  }
}
