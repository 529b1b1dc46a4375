// The 3D view: splats or mesh with a style per class, drawn only when something changes. Only this class uses
// PlayCanvas.
import {
  AppBase, AppOptions, type CameraComponent, CameraComponentSystem, Color, Entity, type EventHandler, FILLMODE_NONE, FILTER_NEAREST, GSplatComponentSystem,
  GSplatHandler, type Layer, PIXELFORMAT_RGBA8, Quat, RESOLUTION_AUTO, RenderComponentSystem, Texture, TextureHandler, Vec3,
  createGraphicsDevice,
} from 'playcanvas';
import { type CameraInfo } from './api';
import { type Columns } from './columns';
import { type CutBounds } from './cut_box';
import { DrawOrder } from './draw_order';
import { DrawQuality, pixelRatio } from './draw_quality';
import { DrawnSplats, type ClassStyle } from './drawn_splats';
import { verticesOf } from './mesh_glow';
import { MeshLayer } from './mesh_layer';
import { MeshPicker } from './mesh_pick';
import { fetchMesh, type PlyMesh } from './mesh_ply';
import { pickSplat, type Hit, type Splats } from './pick';
import { RoomBox } from './room_box';
import { frustaLines, rulerLines, SceneLines, type Line } from './scene_lines';
import { SplatCull } from './splat_cull';
import { kStyles, SplatLayer } from './splat_layer';
import { middleOf, solidPoints } from './splat_points';
import { cullViewOf } from './splat_view';
import { rayAt } from './view_rays';
import { kContext } from './webgl_context';

const kWallShare = 0.03;         // of the room's diagonal: 0.2 m in a room of 4 m by 5 m
const kSortTime = 3000, kLook = 20; // milliseconds that a sorted picture is waited for, and between two looks
const kSettle = 300; // milliseconds of drawing after a change, so that the sorting worker gets it

interface Marked { label: number; instance: number }

export class Viewer {
  readonly camera = new Entity('camera');
  readonly world = new Entity('world'); // turns the run's axes so that y is up
  splats: Splats | null = null;
  mesh: PlyMesh | null = null;
  frames = 0;
  settled = false; // the last picture has all splats in their final order, and all pixels
  private hasDrawn = false; // splats, at any time
  private sorted = false; // a picture in the final order was drawn since it was asked for
  onPose: () => void = () => {};
  onFirstSplats: () => void = () => {}; // the first picture of splats is to be seen
  moving: () => boolean = () => false; // a pointer or a key is held
  room: RoomBox | null = null;
  readonly drawn = new DrawnSplats();
  private cutSides = '';
  private layer: SplatLayer | null = null;
  private meshLayer!: MeshLayer;
  private meshPicker = new MeshPicker();
  private styleTexture!: Texture;
  private mix = 0;
  private drawUntil = 0;
  private lines = new SceneLines();
  private glowing: { which: Marked; strength: number } | null = null;
  readonly order: DrawOrder;
  culled: SplatCull | null = null; // null: all splats are drawn
  private displaced = false; // an object is drawn at another place than its splats have
  readonly quality: DrawQuality;

  private constructor(readonly app: AppBase, readonly canvas: HTMLCanvasElement) {
    this.order = new DrawOrder(app, () => (this.culled && !this.displaced ? { splats: this.culled, view: cullViewOf(this) } : null));
    this.quality = new DrawQuality(app, () => this.moving(), () => this.resize(), () => {
      this.layer?.update(); // colours as they are from here: while moving, PlayCanvas keeps those of up to 10 degrees before
      this.draw();
    });
  }

  static async create(canvas: HTMLCanvasElement): Promise<Viewer> {
    const device = await createGraphicsDevice(canvas, { deviceTypes: ['webgl2'], ...kContext } as object);
    device.maxPixelRatio = pixelRatio();
    const options = new AppOptions();
    options.graphicsDevice = device;
    options.componentSystems = [RenderComponentSystem, CameraComponentSystem, GSplatComponentSystem];
    options.resourceHandlers = [TextureHandler, GSplatHandler];
    const app = new AppBase(canvas);
    app.init(options);
    app.setCanvasFillMode(FILLMODE_NONE);
    app.setCanvasResolution(RESOLUTION_AUTO);
    app.autoRender = false;
    const viewer = new Viewer(app, canvas);
    viewer.camera.addComponent('camera', { clearColor: new Color(0.09, 0.1, 0.12), fov: 60, nearClip: 0.02, farClip: 500 });
    app.root.addChild(viewer.camera);
    app.root.addChild(viewer.world);
    viewer.meshLayer = new MeshLayer(app, viewer.world);
    viewer.styleTexture = new Texture(device, {
      name: 'styles', width: kStyles, height: 2, format: PIXELFORMAT_RGBA8, mipmaps: false, minFilter: FILTER_NEAREST, magFilter: FILTER_NEAREST,
    });
    // The worker that sorts answers when it likes: then there is something new to draw.
    const splatSystem = (app.systems as unknown as { gsplat: EventHandler }).gsplat;
    splatSystem.on('frame:request', () => { app.renderNextFrame = true; });
    splatSystem.on('frame:ready', (camera: CameraComponent, layer: Layer, ready: boolean, loading: number) => {
      viewer.order.watch(camera, layer);
      if (ready && loading === 0) {
        if (!viewer.hasDrawn) requestAnimationFrame(() => viewer.onFirstSplats());
        viewer.sorted = viewer.hasDrawn = true;
      }
      viewer.settled = ready && loading === 0 && viewer.order.final && !viewer.quality.moves;
    });
    app.on('update', () => { if (viewer.order.again() || performance.now() < viewer.drawUntil) app.renderNextFrame = true; });
    app.on('prerender', () => { ++viewer.frames; viewer.quality.frame(); viewer.lines.draw(app); });
    app.start();
    // The canvas is given the size of its place in pixels, so that place is watched.
    new ResizeObserver(() => { viewer.resize(); viewer.draw(); }).observe(canvas.parentElement!);
    return viewer;
  }

  /// The last picture is final: nothing moves, and nothing is left to sort or to draw.
  get resting(): boolean { return !this.quality.moves && (this.settled || this.showsMesh) && performance.now() >= this.drawUntil && !this.app.renderNextFrame; }

  /// The splats are drawn in their order, or seconds have passed.
  async nextPicture(): Promise<void> {
    if (this.showsMesh || document.hidden) return; // nothing is sorted there
    this.sorted = false;
    this.draw();
    for (const end = performance.now() + kSortTime; !this.sorted && performance.now() < end;) await new Promise((later) => window.setTimeout(later, kLook));
  }

  /// Asks for new pictures, for as long as sorting may take.
  draw(): void {
    this.app.renderNextFrame = true;
    this.settled = false;
    this.drawUntil = performance.now() + kSettle;
  }

  /// The camera has moved: fewer pixels and no faint splats until it rests, and walls that are in the way go.
  moved(): void {
    this.quality.moved();
    this.cutWalls();
    this.draw();
    this.onPose();
  }

  resize(): void {
    const place = this.canvas.parentElement!;
    this.app.resizeCanvas(place.clientWidth, place.clientHeight);
  }

  private cutWalls(): void {
    const cuts = this.room?.cuts(this.camera.getPosition()) ?? [], key = cuts.map((c) => c.normal.toString()).join();
    if (key === this.cutSides) return;
    this.cutSides = key;
    this.drawn.cuts = cuts;
    this.drawn.wall = kWallShare * (this.room?.diagonal ?? 1);
    this.layer?.cut(cuts, this.drawn.wall);
  }

  setUp(up: Vec3): void {
    this.world.setLocalRotation(new Quat().setFromDirections(up.clone().normalize(), Vec3.UP));
    this.drawn.setTurn(this.world.getWorldTransform());
  }

  setBackground(dark: boolean): void {
    this.camera.camera!.clearColor = dark ? new Color(0.09, 0.1, 0.12) : new Color(0.93, 0.94, 0.95);
    this.draw();
  }

  /// A place or a direction of the y-up world in the scene's own axes.
  fromWorld(v: Vec3, place: boolean): number[] {
    const back = this.world.getWorldTransform().clone().invert(), out = place ? back.transformPoint(v) : back.transformVector(v);
    return [out.x, out.y, out.z];
  }

  toWorld(p: number[]): Vec3 { return this.world.getWorldTransform().transformPoint(new Vec3(p[0], p[1], p[2])); }

  /// Draws these splats instead of those before.
  setSplats(columns: Columns): void {
    const old = this.layer;
    this.layer = new SplatLayer(this.app.graphicsDevice, this.world, columns, this.styleTexture);
    this.splats = this.layer.splats;
    this.culled = new SplatCull(this.splats);
    this.layer.entity.enabled = old ? old.entity.enabled : true;
    old?.destroy();
    this.room = RoomBox.of(solidPoints(this.splats, (p) => this.toWorld(p)));
    this.cutSides = '';
    this.cutWalls();
    this.layer.showObjects(this.drawn.hiddenObjects);
    this.applyStyles();
  }

  /// Lets an object glow; `strength` 0 to 1.
  glow(which: Marked | null, strength = 0.5): void {
    this.glowing = which && { which, strength };
    this.layer?.glow(which, strength);
    if (this.showsMesh) this.glowMesh();
    this.draw();
  }

  private glowMesh(): void {
    const { mesh, splats, glowing } = this;
    if (mesh) this.meshLayer.glow(glowing && verticesOf(mesh, splats, glowing.which), glowing?.strength ?? 0);
  }

  /// Draws an object at another place until new splats come; null: where it is.
  moveObject(which: Marked | null, shift = new Vec3()): void {
    this.displaced = which !== null;
    this.layer?.move(which, [shift.x, shift.y, shift.z]);
    this.draw();
  }

  /// Draws what is in a box alone, and its edges.
  cutTo(box: CutBounds | null, edges: Line[]): void {
    this.drawn.box = box;
    this.layer?.box(box);
    this.lines.set('box', edges);
    if (this.mesh) this.meshLayer.keep(this.mesh, (corner) => this.drawn.hasTriangle(this.mesh!, corner));
    this.draw();
  }

  /// Marks splats, one flag each; null: none.
  mark(flags: Uint8Array | null): void {
    this.layer?.mark(flags);
    this.draw();
  }

  /// Objects (objectKey) that are not drawn and not picked.
  hideObjects(hidden: Set<string>): void {
    this.drawn.hiddenObjects = hidden;
    this.layer?.showObjects(hidden);
    this.draw();
  }

  async loadMesh(url: string): Promise<void> { this.setMesh(await fetchMesh(url)); }

  setMesh(mesh: PlyMesh): void {
    this.mesh = mesh;
    this.buildMesh();
  }

  private buildMesh(): void {
    const mesh = this.mesh!;
    this.meshLayer.build(mesh, (label) => this.style(label), this.mix, (corner) => this.drawn.hasTriangle(mesh, corner));
    this.glowMesh();
    this.draw();
  }

  get showsMesh(): boolean { return this.meshLayer.shown; }

  show(what: 'splats' | 'mesh'): void {
    if (this.layer) this.layer.entity.enabled = what === 'splats';
    this.meshLayer.show(what === 'mesh');
    this.glowMesh();
    this.draw();
  }

  /// Styles by class; `mix` 0: own colours, 1: the classes' colours.
  setStyles(styles: ClassStyle[], mix: number): void {
    this.drawn.styles = styles;
    this.mix = mix;
    this.applyStyles();
    if (this.mesh) this.buildMesh();
  }

  style(label: number): ClassStyle { return this.drawn.style(label); }

  private applyStyles(): void {
    const data = this.styleTexture.lock() as Uint8Array, mix = this.splats?.labels ? this.mix : 0;
    for (let i = 0; i < kStyles; ++i) {
      const s = this.style(i);
      data.set([...s.color, Math.round(255 * mix)], 4 * i);
      data.set([s.visible ? 255 : 0, s.shell ? 255 : 0, 0, 0], 4 * (kStyles + i));
    }
    this.styleTexture.unlock();
    this.layer?.update();
    this.draw();
  }

  /// Looks from one place of the y-up world at another; `fov`: degrees, vertical.
  lookFrom(eye: Vec3, target: Vec3, fov: number): void {
    this.camera.setPosition(eye);
    this.camera.lookAt(target);
    this.camera.camera!.fov = fov;
    this.moved();
  }

  setFrusta(cameras: CameraInfo[], size: number): void {
    this.lines.set('cameras', frustaLines(cameras, size, (p) => this.toWorld(p)));
    this.draw();
  }

  /// Crosses at places of the y-up world, and a line between the two of each pair.
  setRuler(points: Vec3[]): void {
    this.lines.set('ruler', rulerLines(points));
    this.draw();
  }

  /// The object under a point of the canvas (CSS pixels of the window), and its place in the y-up world.
  pick(x: number, y: number): { hit: Hit; point: Vec3 } | null {
    const { eye, direction } = rayAt(this, x, y), origin = this.fromWorld(eye, true), along = this.fromWorld(direction, false);
    const { splats, mesh, drawn } = this;
    const hit = this.showsMesh && mesh ? this.meshPicker.pick(mesh, splats, origin, along, (corner) => drawn.hasTriangle(mesh, corner))
      : splats && pickSplat(splats, origin, along, (i) => drawn.has(splats, i));
    return hit && { hit, point: eye.clone().add(direction.clone().mulScalar(hit.distance)) };
  }

  /// The middle of the room, in the y-up world.
  middle(): Vec3 { return this.splats ? middleOf(this.splats, (p) => this.toWorld(p)) : new Vec3(); }
}
