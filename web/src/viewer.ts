// The 3D view: splats or mesh with a style per class, drawn only when something changes. Only this class uses
// PlayCanvas.
import {
  AppBase, AppOptions, Asset, CameraComponentSystem, Color, Entity, type EventHandler, FILLMODE_NONE, FILTER_NEAREST, GSplatComponentSystem,
  GSplatHandler, GSPLAT_STREAM_INSTANCE, Mesh, MeshInstance, PIXELFORMAT_RGBA8, Quat, RESOLUTION_AUTO, RenderComponentSystem,
  StandardMaterial, Texture, TextureHandler, Vec3, WORKBUFFER_UPDATE_ONCE, createGraphicsDevice, type GSplatResource,
} from 'playcanvas';
import { type CameraInfo } from './api';
import { parseMeshPly, type PlyMesh } from './mesh_ply';
import { kLeastAlpha, pickSplat, type Hit, type Splats } from './pick';

export interface ClassStyle { color: [number, number, number]; visible: boolean }

const kStyles = 256; // classes that can be styled; 255: no class
const kLinear = Uint8Array.from({ length: 256 }, (_, i) => Math.round(255 * (i / 255) ** 2.2)); // sRGB to linear
const kSettle = 300; // milliseconds of drawing after a change, so that the sorting worker receives it

export class Viewer {
  readonly camera = new Entity('camera');
  readonly world = new Entity('world'); // turns the run's axes so that y is up
  splats: Splats | null = null;
  mesh: PlyMesh | null = null;
  frames = 0;
  settled = false; // the last picture has all splats in their final order
  onPose: () => void = () => {};
  private splatEntity: Entity | null = null;
  private splatAsset: Asset | null = null;
  private meshEntity: Entity | null = null;
  private styleTexture!: Texture;
  private styles: ClassStyle[] = [];
  private mix = 0;
  private drawUntil = 0;
  private lines: { points: Vec3[]; color: Color }[] = [];

  private constructor(readonly app: AppBase, readonly canvas: HTMLCanvasElement) {}

  static async create(canvas: HTMLCanvasElement): Promise<Viewer> {
    const device = await createGraphicsDevice(canvas, { deviceTypes: ['webgl2'], antialias: false, preserveDrawingBuffer: true } as object);
    device.maxPixelRatio = Math.min(window.devicePixelRatio, 1.5);
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
    splatSystem.on('frame:ready', (_camera: unknown, _layer: unknown, ready: boolean, loading: number) => { viewer.settled = ready && loading === 0; });
    app.on('update', () => { if (performance.now() < viewer.drawUntil) app.renderNextFrame = true; });
    app.on('prerender', () => { ++viewer.frames; for (const l of viewer.lines) app.drawLines(l.points, l.color); });
    app.start();
    new ResizeObserver(() => { app.resizeCanvas(canvas.clientWidth, canvas.clientHeight); viewer.draw(); }).observe(canvas);
    return viewer;
  }

  /// Asks for new pictures, for as long as sorting may take.
  draw(): void {
    this.app.renderNextFrame = true;
    this.settled = false;
    this.drawUntil = performance.now() + kSettle;
    this.onPose();
  }

  setUp(up: Vec3): void {
    this.world.setLocalRotation(new Quat().setFromDirections(up.clone().normalize(), Vec3.UP));
  }

  toWorld(p: number[]): Vec3 { return this.world.getWorldTransform().transformPoint(new Vec3(p[0], p[1], p[2])); }

  async loadSplats(url: string): Promise<void> {
    const asset = new Asset('splats', 'gsplat', { url, filename: 'scene.ply' }, { reorder: false } as object);
    this.app.assets.add(asset);
    await new Promise<void>((resolve, reject) => {
      asset.once('error', (e: string) => reject(new Error(e)));
      asset.ready(() => resolve());
      this.app.assets.load(asset);
    });
    const entity = new Entity('splats');
    entity.addComponent('gsplat', { asset });
    const resource = asset.resource as GSplatResource;
    this.splats = readSplats(resource);
    this.attachStyles(entity, resource);
    const old = this.splatEntity, oldAsset = this.splatAsset;
    this.world.addChild(entity);
    entity.enabled = old ? old.enabled : true;
    this.splatEntity = entity;
    this.splatAsset = asset;
    old?.destroy();
    if (oldAsset) { this.app.assets.remove(oldAsset); oldAsset.unload(); }
    this.applyStyles();
  }

  private attachStyles(entity: Entity, resource: GSplatResource): void {
    const splats = this.splats!;
    if (!splats.labels) return;
    resource.format.addExtraStreams([{ name: 'splatLabel', format: PIXELFORMAT_RGBA8, storage: GSPLAT_STREAM_INSTANCE }]);
    const texture = entity.gsplat!.getInstanceTexture('splatLabel')!;
    const data = texture.lock() as Uint8Array;
    for (let i = 0; i < splats.count; ++i) data[4 * i] = Math.min(kStyles - 1, splats.labels[i]);
    texture.unlock();
    entity.gsplat!.setParameter('aligngsStyle', this.styleTexture as unknown as number);
    entity.gsplat!.setWorkBufferModifier({ glsl: `
      uniform sampler2D aligngsStyle;
      void modifySplatCenter(inout vec3 center) {}
      void modifySplatRotationScale(vec3 originalCenter, vec3 modifiedCenter, inout vec4 rotation, inout vec3 scale) {}
      void modifySplatColor(vec3 center, inout vec4 color) {
        int label = int(loadSplatLabel().r * 255.0 + 0.5);
        vec4 style = texelFetch(aligngsStyle, ivec2(label, 0), 0);
        color.rgb = mix(color.rgb, style.rgb, style.a);
        color.a *= texelFetch(aligngsStyle, ivec2(label, 1), 0).r;
      }` } as never);
  }

  async loadMesh(url: string): Promise<void> {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`mesh: the server answered ${answer.status}`);
    this.mesh = parseMeshPly(await answer.arrayBuffer());
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
    if (this.splatEntity) this.splatEntity.enabled = what === 'splats';
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
      data.set([s.visible ? 255 : 0, 0, 0, 0], 4 * (kStyles + i));
    }
    this.styleTexture.unlock();
    if (this.splatEntity?.gsplat) this.splatEntity.gsplat.workBufferUpdate = WORKBUFFER_UPDATE_ONCE;
    this.draw();
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
    this.draw();
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

  setRuler(points: Vec3[]): void {
    this.lines = this.lines.filter((l) => l.color.b > 0.5);
    const arm = 0.03;
    for (const p of points) {
      for (const d of [new Vec3(arm, 0, 0), new Vec3(0, arm, 0), new Vec3(0, 0, arm)]) {
        this.lines.push({ points: [p.clone().sub(d), p.clone().add(d)], color: new Color(1, 0.9, 0.1) });
      }
    }
    if (points.length === 2) this.lines.push({ points, color: new Color(1, 0.9, 0.1) });
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
    const hit = pickSplat(this.splats, [o.x, o.y, o.z], [d.x, d.y, d.z], (label) => !this.style(label).visible);
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
}

function readSplats(resource: GSplatResource): Splats {
  const data = resource.gsplatData as unknown as { numSplats: number; getProp(name: string): ArrayLike<number> | undefined };
  const n = data.numSplats;
  const column = (name: string) => data.getProp(name);
  const columns = (names: string[], map: (v: number) => number) => {
    const out = new Float32Array(n * names.length);
    names.forEach((name, k) => {
      const values = column(name)!;
      for (let i = 0; i < n; ++i) out[i * names.length + k] = map(values[i]);
    });
    return out;
  };
  const rotations = columns(['rot_0', 'rot_1', 'rot_2', 'rot_3'], (v) => v);
  for (let i = 0; i < n; ++i) {
    const l = Math.hypot(rotations[4 * i], rotations[4 * i + 1], rotations[4 * i + 2], rotations[4 * i + 3]) || 1;
    for (let k = 0; k < 4; ++k) rotations[4 * i + k] /= l;
  }
  const integers = <T>(name: string, make: (v: ArrayLike<number>) => T): T | null => {
    const values = column(name);
    return values ? make(values) : null;
  };
  return {
    count: n, centres: columns(['x', 'y', 'z'], (v) => v), scales: columns(['scale_0', 'scale_1', 'scale_2'], Math.exp), rotations,
    opacities: columns(['opacity'], (v) => 1 / (1 + Math.exp(-v))),
    labels: integers('label', (v) => Uint16Array.from(v)), instances: integers('instance', (v) => Uint16Array.from(v)),
    confidences: integers('confidence', (v) => Uint8Array.from(v)),
  };
}
