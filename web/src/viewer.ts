// The 3D view: splats or mesh with a style per class, drawn only when something changes. Only this class uses
// PlayCanvas.
import {
  AppBase, AppOptions, CameraComponentSystem, Color, Entity, type EventHandler, FILLMODE_NONE, FILTER_NEAREST, GSplatComponentSystem,
  GSplatHandler, Mesh, MeshInstance, PIXELFORMAT_RGBA8, Quat, RESOLUTION_AUTO, RESOLUTION_FIXED, RenderComponentSystem, StandardMaterial, Texture,
  TextureHandler, Vec3, createGraphicsDevice,
} from 'playcanvas';
import { request, type CameraInfo } from './api';
import { type Columns } from './columns';
import { parseMeshPly, type PlyMesh } from './mesh_ply';
import { MovingQuality } from './moving_quality';
import { kLeastAlpha, pickSplat, type Hit, type Splats } from './pick';
import { RoomBox } from './room_box';
import { kStyles, objectKey, SplatLayer } from './splat_layer';
import { kContext } from './webgl_context';

/// `shell`: walls, ceiling and what hangs on them; it is cut away where it hides the room.
export interface ClassStyle { color: [number, number, number]; visible: boolean; shell?: boolean }

const kLinear = Uint8Array.from({ length: 256 }, (_, i) => Math.round(255 * (i / 255) ** 2.2)); // sRGB to linear
const kMostPixelRatio = 1.5;     // device pixels a CSS pixel: more is not seen and costs time
const kMovingAlpha = 1 / 32;     // opacity below which a splat is not drawn then
const kLeastSize = 2, kMovingSize = 3; // pixels below which a splat is not drawn, at rest and while the camera moves
const kPoints = 8000;            // splats that the room's box is made of
const kSolid = 0.3;              // opacity of a splat that is no haze
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
  private cutSides = '';
  private hiddenObjects = new Set<string>();
  private sharp = 0; // timer: the full quality comes back
  private quality = new MovingQuality();
  private drawsMoving = false;
  private framesBefore = 0; // frames when the camera moved last
  private layer: SplatLayer | null = null;
  private meshEntity: Entity | null = null;
  private styleTexture!: Texture;
  private styles: ClassStyle[] = [];
  private mix = 0;
  private drawUntil = 0;
  private lines: { points: Vec3[]; color: Color }[] = [];

  private constructor(readonly app: AppBase, readonly canvas: HTMLCanvasElement) {}

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
    viewer.styleTexture = new Texture(device, {
      name: 'styles', width: kStyles, height: 2, format: PIXELFORMAT_RGBA8, mipmaps: false, minFilter: FILTER_NEAREST, magFilter: FILTER_NEAREST,
    });
    // The worker that sorts answers when it likes: then there is something new to draw.
    const splatSystem = (app.systems as unknown as { gsplat: EventHandler }).gsplat;
    splatSystem.on('frame:request', () => { app.renderNextFrame = true; });
    splatSystem.on('frame:ready', (_camera: unknown, _layer: unknown, ready: boolean, loading: number) => { viewer.sorted ||= ready && loading === 0; viewer.settled = ready && loading === 0 && !viewer.drawsMoving; });
    app.on('update', () => { if (performance.now() < viewer.drawUntil) app.renderNextFrame = true; });
    app.on('prerender', () => { ++viewer.frames; if (viewer.drawsMoving) viewer.quality.frame(performance.now()); for (const l of viewer.lines) app.drawLines(l.points, l.color); });
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
    this.layer?.cut(cuts, kWallShare * (this.room?.diagonal ?? 1));
  }

  setUp(up: Vec3): void {
    this.world.setLocalRotation(new Quat().setFromDirections(up.clone().normalize(), Vec3.UP));
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
    this.room = RoomBox.of(this.seenPoints());
    this.cutSides = '';
    this.cutWalls();
    this.layer.showObjects(this.hiddenObjects);
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

  /// Objects (objectKey) that are not drawn and not picked.
  hideObjects(hidden: Set<string>): void {
    this.hiddenObjects = hidden;
    this.layer?.showObjects(hidden);
    this.draw();
  }

  async loadMesh(url: string): Promise<void> {
    const answer = await request(url);
    if (!answer.ok) throw new Error(`The mesh cannot be loaded. The server answered ${answer.status}.`);
    this.setMesh(parseMeshPly(await answer.arrayBuffer()));
  }

  setMesh(mesh: PlyMesh): void {
    this.mesh = mesh;
    this.buildMesh();
  }

  private buildMesh(): void {
    const ply = this.mesh!;
    const show = !this.meshEntity || this.meshEntity.enabled;
    this.meshEntity?.destroy();
    const colors = new Uint8Array(ply.colors);
    let indices = ply.indices;
    if (ply.labels) {
      for (let i = 0; i < ply.labels.length; ++i) {
        const c = this.style(ply.labels[i]).color;
        for (let k = 0; k < 3; ++k) colors[4 * i + k] = (1 - this.mix) * colors[4 * i + k] + this.mix * c[k];
      }
      const kept = new Uint32Array(indices.length);
      let n = 0;
      for (let f = 0; f < indices.length; f += 3) {
        if (!this.style(ply.labels[indices[f]]).visible) continue;
        kept[n++] = indices[f]; kept[n++] = indices[f + 1]; kept[n++] = indices[f + 2];
      }
      indices = kept.slice(0, n);
    }
    // The camera's output is converted to sRGB once more, the colours of the file are sRGB already.
    for (let i = 0; i < colors.length; ++i) if (i % 4 < 3) colors[i] = kLinear[colors[i]];
    const mesh = new Mesh(this.app.graphicsDevice);
    mesh.setPositions(ply.positions);
    mesh.setColors32(colors);
    mesh.setIndices(indices);
    mesh.update();
    const material = new StandardMaterial();
    material.useLighting = false;
    material.emissive = new Color(1, 1, 1);
    material.emissiveVertexColor = true;
    material.diffuse = new Color(0, 0, 0);
    material.cull = 0; // both sides: rooms are looked at from inside
    material.update();
    const entity = new Entity('mesh');
    entity.addComponent('render', { meshInstances: [new MeshInstance(mesh, material)] });
    this.world.addChild(entity);
    entity.enabled = show;
    this.meshEntity = entity;
    this.draw();
  }

  get showsMesh(): boolean { return !!this.meshEntity?.enabled; }

  show(what: 'splats' | 'mesh'): void {
    if (this.layer) this.layer.entity.enabled = what === 'splats';
    if (this.meshEntity) this.meshEntity.enabled = what === 'mesh';
    this.draw();
  }

  /// Styles by class; `mix` 0: own colours, 1: the classes' colours.
  setStyles(styles: ClassStyle[], mix: number): void {
    this.styles = styles;
    this.mix = mix;
    this.applyStyles();
    if (this.mesh) this.buildMesh();
  }

  style(label: number): ClassStyle { return this.styles[label] ?? { color: [128, 128, 128], visible: true }; }

  private applyStyles(): void {
    const data = this.styleTexture.lock() as Uint8Array;
    for (let i = 0; i < kStyles; ++i) {
      const s = this.style(i);
      data.set([...s.color, Math.round(255 * this.mix)], 4 * i);
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

  /// Puts the camera where a photo was taken, with its field of view; `fit` is the part of the canvas the photo fills.
  lookThrough(c: CameraInfo): { width: number; height: number } {
    const R = c.rotation, turn = this.world.getRotation();
    const axis = (k: number, sign: number) => turn.transformVector(new Vec3(sign * R[0][k], sign * R[1][k], sign * R[2][k]));
    const eye = this.toWorld(c.position);
    this.camera.setPosition(eye);
    this.camera.lookAt(eye.clone().add(axis(2, 1)), axis(1, -1));
    const w = this.canvas.clientWidth, h = this.canvas.clientHeight, scale = Math.min(w / c.width, h / c.height);
    this.camera.camera!.fov = (2 * Math.atan((0.5 * h) / (c.fy * scale)) * 180) / Math.PI;
    this.moved();
    return { width: c.width * scale, height: c.height * scale };
  }

  setFrusta(cameras: CameraInfo[], size: number): void {
    this.lines = this.lines.filter((l) => l.color.b > 0.5 === false);
    for (const c of cameras) {
      const corner = (u: number, v: number) => {
        const q = [((u - 0.5) * c.width * size) / c.fx, ((v - 0.5) * c.height * size) / c.fy, size];
        return this.toWorld([0, 1, 2].map((k) => c.position[k] + c.rotation[k][0] * q[0] + c.rotation[k][1] * q[1] + c.rotation[k][2] * q[2]));
      };
      const eye = this.toWorld(c.position), k = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
      const color = c.split === 'test' ? new Color(1, 0.6, 0.9) : new Color(0.3, 0.8, 1);
      this.lines.push({ points: [eye, k[0], eye, k[1], eye, k[2], eye, k[3], k[0], k[1], k[1], k[2], k[2], k[3], k[3], k[0]], color });
    }
    this.draw();
  }

  /// Crosses at places of the y-up world, and a line between the two of each pair.
  setRuler(points: Vec3[]): void {
    this.lines = this.lines.filter((l) => l.color.b > 0.5);
    const arm = 0.03;
    for (const p of points) {
      for (const d of [new Vec3(arm, 0, 0), new Vec3(0, arm, 0), new Vec3(0, 0, arm)]) {
        this.lines.push({ points: [p.clone().sub(d), p.clone().add(d)], color: new Color(1, 0.9, 0.1) });
      }
    }
    for (let k = 0; k + 1 < points.length; k += 2) this.lines.push({ points: [points[k], points[k + 1]], color: new Color(1, 0.9, 0.1) });
    this.draw();
  }

  /// The object under a point of the canvas (CSS pixels), and its place in the y-up world.
  pick(x: number, y: number): { hit: Hit; point: Vec3 } | null {
    if (!this.splats) return null;
    const box = this.canvas.getBoundingClientRect();
    const far = this.camera.camera!.screenToWorld(x - box.left, y - box.top, 10);
    const eye = this.camera.getPosition(), direction = far.sub(eye).normalize();
    const back = this.world.getWorldTransform().clone().invert();
    const o = back.transformPoint(eye), d = back.transformVector(direction);
    const hit = pickSplat(this.splats, [o.x, o.y, o.z], [d.x, d.y, d.z], (label, instance) => !this.style(label).visible || this.hiddenObjects.has(objectKey(label, instance)));
    return hit && { hit, point: eye.clone().add(direction.mulScalar(hit.distance)) };
  }

  /// Median position of the splats that can be seen: the middle of the room. An exported page has no others.
  middle(): Vec3 {
    const s = this.splats;
    if (!s) return new Vec3();
    const seen = Array.from(s.opacities.keys()).filter((i) => s.opacities[i] >= kLeastAlpha);
    if (seen.length === 0) return new Vec3();
    const median = [0, 1, 2].map((k) => Float32Array.from(seen, (i) => s.centres[3 * i + k]).sort()[seen.length >> 1]);
    return this.toWorld(median);
  }

  /// A sample of the splats that can be seen, in the y-up world.
  private seenPoints(): Vec3[] {
    const s = this.splats!, step = Math.max(1, Math.floor(s.count / kPoints)), points: Vec3[] = [];
    for (let i = 0; i < s.count; i += step) {
      if (s.opacities[i] >= kSolid) points.push(this.toWorld([s.centres[3 * i], s.centres[3 * i + 1], s.centres[3 * i + 2]]));
    }
    return points;
  }
}
