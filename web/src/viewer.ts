// The 3D view: splats or mesh with a style per class, drawn only when something changes. Only this class uses
// PlayCanvas.
import {
  AppBase, AppOptions, type CameraComponent, CameraComponentSystem, Color, Entity, type EventHandler, FILLMODE_NONE, FILTER_NEAREST, GSplatComponentSystem,
  GSplatHandler, type Layer, PIXELFORMAT_RGBA8, Quat, RESOLUTION_AUTO, RESOLUTION_FIXED, RenderComponentSystem, Texture, TextureHandler, Vec3,
  createGraphicsDevice,
} from 'playcanvas';
import { type CameraInfo } from './api';
import { type Columns } from './columns';
import { type CutBounds } from './cut_box';
import { DrawOrder } from './draw_order';
import { DrawnSplats, type ClassStyle } from './drawn_splats';
import { MeshLayer } from './mesh_layer';
import { MeshPicker } from './mesh_pick';
import { fetchMesh, type PlyMesh } from './mesh_ply';
import { MovingQuality } from './moving_quality';
import { kLeastAlpha, pickSplat, type Hit, type Splats } from './pick';
import { RoomBox } from './room_box';
import { frustaLines, rulerLines, SceneLines, type Line } from './scene_lines';
import { kStyles, SplatLayer } from './splat_layer';
import { middleOf, solidPoints } from './splat_points';
import { kContext } from './webgl_context';

const kMostPixelRatio = 1.5;     // device pixels a CSS pixel: more is not seen and costs time
const kMovingAlpha = 1 / 32;     // opacity below which a splat is not drawn then
const kLeastSize = 2, kMovingSize = 3; // pixels below which a splat is not drawn, at rest and while the camera moves
const kWallShare = 0.03;         // of the room's diagonal: 0.2 m in a room of 4 m by 5 m
const kPictureTime = 30000; // milliseconds that a picture of a chosen size may take
const kSortTime = 3000, kLook = 20; // milliseconds that a sorted picture is waited for, and between two looks
const kSettle = 300; // milliseconds of drawing after a change, so that the sorting worker gets it

export class Viewer {
  readonly camera = new Entity('camera');
  readonly world = new Entity('world'); // turns the run's axes so that y is up
  splats: Splats | null = null;
  mesh: PlyMesh | null = null;
  frames = 0;
  settled = false; // the last picture has all splats in their final order, and all pixels
  private sorted = false; // a picture in the final order was drawn since it was asked for
  onPose: () => void = () => {};
  moving: () => boolean = () => false; // a pointer or a key is held
  room: RoomBox | null = null;
  readonly drawn = new DrawnSplats();
  private cutSides = '';
  private sharp = 0; // timer: the full quality comes back
  private quality = new MovingQuality();
  private drawsMoving = false;
  private framesBefore = 0; // frames when the camera moved last
  private layer: SplatLayer | null = null;
  private meshLayer!: MeshLayer;
  private meshPicker = new MeshPicker();
  private styleTexture!: Texture;
  private mix = 0;
  private drawUntil = 0;
  private lines = new SceneLines();
  private order: DrawOrder;

  private constructor(readonly app: AppBase, readonly canvas: HTMLCanvasElement) { this.order = new DrawOrder(app); }

  static async create(canvas: HTMLCanvasElement): Promise<Viewer> {
    const device = await createGraphicsDevice(canvas, { deviceTypes: ['webgl2'], ...kContext } as object);
    device.maxPixelRatio = Math.min(window.devicePixelRatio, kMostPixelRatio);
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
      viewer.sorted ||= ready && loading === 0;
      viewer.settled = ready && loading === 0 && viewer.order.final && !viewer.drawsMoving;
    });
    app.on('update', () => { if (viewer.order.again() || performance.now() < viewer.drawUntil) app.renderNextFrame = true; });
    app.on('prerender', () => { ++viewer.frames; if (viewer.drawsMoving) viewer.quality.frame(performance.now()); viewer.lines.draw(app); });
    app.start();
    // The canvas is given the size of its place in pixels, so that place is watched.
    new ResizeObserver(() => { viewer.resize(); viewer.draw(); }).observe(canvas.parentElement!);
    return viewer;
  }

  /// The last picture is final: nothing moves, and nothing is left to sort or to draw.
  get resting(): boolean { return !this.drawsMoving && (this.settled || this.showsMesh) && performance.now() >= this.drawUntil && !this.app.renderNextFrame; }

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
    this.setQuality(true);
    this.framesBefore = this.frames;
    this.restAgain();
    this.cutWalls();
    this.draw();
    this.onPose();
  }

  /// The full quality comes back when the camera rests; a slow picture is no rest.
  private restAgain(): void {
    window.clearTimeout(this.sharp);
    this.sharp = window.setTimeout(() => {
      if (this.moving() || this.frames === this.framesBefore) { this.restAgain(); return; }
      this.setQuality(false);
      this.layer?.update(); // colours as they are from here: while moving, PlayCanvas keeps those of up to 10 degrees before
      this.draw();
    }, this.quality.patience);
  }

  private setQuality(moving: boolean): void {
    const { gsplat } = this.app.scene, reduced = moving && this.quality.reduced;
    gsplat.alphaClipForward = reduced ? kMovingAlpha : kLeastAlpha;
    gsplat.minPixelSize = reduced ? kMovingSize : kLeastSize;
    if (!moving) this.quality.rest();
    this.drawsMoving = moving;
    const device = this.app.graphicsDevice, ratio = (moving ? this.quality.share : 1) * Math.min(window.devicePixelRatio, kMostPixelRatio);
    if (device.maxPixelRatio === ratio) return;
    device.maxPixelRatio = ratio;
    this.resize();
  }

  private resize(): void {
    const place = this.canvas.parentElement!;
    this.app.resizeCanvas(place.clientWidth, place.clientHeight);
  }

  /// The view at a size of its own, as a PNG file; what is on the screen stays.
  async picture(width: number, height: number): Promise<Blob> {
    const { app } = this;
    try {
      this.setQuality(false);
      app.setCanvasResolution(RESOLUTION_FIXED, width, height);
      app.graphicsDevice.setResolution(width, height); // whatever the pixels of the screen are
      for (const end = performance.now() + kPictureTime; ;) {
        this.draw();
        await new Promise(requestAnimationFrame);
        await new Promise(requestAnimationFrame);
        if (this.showsMesh || this.settled) break;
        if (performance.now() > end) throw new Error('The picture does not come to rest. Try again without moving the camera.');
      }
      const blob = await new Promise<Blob | null>((done) => this.canvas.toBlob(done, 'image/png'));
      if (!blob || this.canvas.width !== width || this.canvas.height !== height) throw new Error(`This browser cannot draw ${width} × ${height} pixels.`);
      return blob;
    } finally {
      app.setCanvasResolution(RESOLUTION_AUTO);
      this.resize();
      this.draw();
    }
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
    this.layer.entity.enabled = old ? old.entity.enabled : true;
    old?.destroy();
    this.room = RoomBox.of(solidPoints(this.splats, (p) => this.toWorld(p)));
    this.cutSides = '';
    this.cutWalls();
    this.layer.showObjects(this.drawn.hiddenObjects);
    this.applyStyles();
  }

  /// Lets an object glow; `strength` 0 to 1.
  glow(which: { label: number; instance: number } | null, strength = 0.5): void {
    this.layer?.glow(which, strength);
    this.draw();
  }

  /// Draws an object at another place until new splats come; null: where it is.
  moveObject(which: { label: number; instance: number } | null, shift = new Vec3()): void {
    this.layer?.move(which, [shift.x, shift.y, shift.z]);
    this.draw();
  }

  /// The place of a level of the y-up world that is under a point of the canvas (CSS pixels); null: none.
  atHeight(x: number, y: number, height: number): Vec3 | null {
    const box = this.canvas.getBoundingClientRect(), eye = this.camera.getPosition();
    const direction = this.camera.camera!.screenToWorld(x - box.left, y - box.top, 10).sub(eye).normalize();
    const along = (height - eye.y) / direction.y;
    return Number.isFinite(along) && along > 0 ? eye.clone().add(direction.mulScalar(along)) : null;
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
    this.draw();
  }

  get showsMesh(): boolean { return this.meshLayer.shown; }

  show(what: 'splats' | 'mesh'): void {
    if (this.layer) this.layer.entity.enabled = what === 'splats';
    this.meshLayer.show(what === 'mesh');
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

  /// The object under a point of the canvas (CSS pixels), and its place in the y-up world.
  pick(x: number, y: number): { hit: Hit; point: Vec3 } | null {
    const box = this.canvas.getBoundingClientRect();
    const far = this.camera.camera!.screenToWorld(x - box.left, y - box.top, 10);
    const eye = this.camera.getPosition(), direction = far.sub(eye).normalize();
    const back = this.world.getWorldTransform().clone().invert();
    const o = back.transformPoint(eye), d = back.transformVector(direction);
    const { splats, mesh, drawn } = this, origin = [o.x, o.y, o.z], along = [d.x, d.y, d.z];
    const hit = this.showsMesh && mesh ? this.meshPicker.pick(mesh, splats, origin, along, (corner) => drawn.hasTriangle(mesh, corner))
      : splats && pickSplat(splats, origin, along, (i) => drawn.has(splats, i));
    return hit && { hit, point: eye.clone().add(direction.mulScalar(hit.distance)) };
  }

  /// The middle of the room, in the y-up world.
  middle(): Vec3 { return this.splats ? middleOf(this.splats, (p) => this.toWorld(p)) : new Vec3(); }
}
