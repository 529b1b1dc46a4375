// One scene of splats in the 3D view. Its shader takes the colours and the visibility of the classes from a texture.
import {
  Entity, GSPLAT_STREAM_INSTANCE, GSplatData, GSplatResource, PIXELFORMAT_RGBA8, WORKBUFFER_UPDATE_ONCE, type GraphicsDevice, type Texture,
} from 'playcanvas';
import { type Columns } from './columns';
import { type CutBounds } from './cut_box';
import { objectKey } from './drawn_splats';
import { type Splats } from './pick';
import { type Cut } from './room_box';

export const kStyles = 256; // classes that can be styled; 255: no class
const kHidden = 0, kMarked = 128, kPlain = 255; // states of a splat in splatLabel
const kCuts = 3, kNoCut = [0, 0, 0, 1e3];        // sides that are cut away at a time
const kWholeSide = [1, 0, -1e3, 1e3];                // of the box: nothing is cut

/// Class, object number (low and high byte) and state of each splat come in splatLabel: hidden, marked or neither. Row 0 of aligngsStyle is the
/// colour of a class. Row 1 tells whether it is drawn (r) and whether it belongs to the shell of the room (g).
const kModifier = `
  uniform sampler2D aligngsStyle;
  uniform vec4 aligngsGlow;    // class, object number or -1 for all, strength
  uniform vec4 aligngsCut0;    // sides of the room that are in the way: normal, offset; (0, 0, 0, 1000): none
  uniform vec4 aligngsCut1;
  uniform vec4 aligngsCut2;
  uniform float aligngsWall;   // how thick a wall is, scene units
  uniform vec4 aligngsBox0;    // the box that cuts the room: level axis (x, z), from, to
  uniform vec4 aligngsBox1;    // height: from, to
  uniform vec4 aligngsBox2;    // the other level axis
  uniform vec4 aligngsMoved;   // the object that is dragged, as aligngsGlow
  uniform vec3 aligngsShift;   // and how far, y-up world
  bool isOf(vec4 which) {
    vec4 own = loadSplatLabel();
    float number = floor(own.g * 255.0 + 0.5) + 256.0 * floor(own.b * 255.0 + 0.5);
    return abs(floor(own.r * 255.0 + 0.5) - which.x) < 0.5 && (which.y < 0.0 || abs(number - which.y) < 0.5);
  }
  void modifySplatCenter(inout vec3 center) {
    if (isOf(aligngsMoved)) center += aligngsShift;
  }
  void modifySplatRotationScale(vec3 originalCenter, vec3 modifiedCenter, inout vec4 rotation, inout vec3 scale) {}
  float beyond(vec3 center, vec4 cut, bool shell) {
    float d = dot(center, cut.xyz) - cut.w;
    return 1.0 - smoothstep(0.0, aligngsWall, shell ? d : d - 2.0 * aligngsWall);
  }
  float inside(float at, float from, float to) { return step(from, at) * step(at, to); }
  void modifySplatColor(vec3 center, inout vec4 color) {
    vec4 own = loadSplatLabel();
    int label = int(own.r * 255.0 + 0.5);
    vec4 style = texelFetch(aligngsStyle, ivec2(label, 0), 0), flags = texelFetch(aligngsStyle, ivec2(label, 1), 0);
    bool shell = flags.g > 0.5;
    color.rgb = mix(color.rgb, style.rgb, style.a);
    color.a *= flags.r * step(0.25, own.a);
    color.a *= beyond(center, aligngsCut0, shell) * beyond(center, aligngsCut1, shell) * beyond(center, aligngsCut2, shell);
    if (isOf(aligngsGlow)) {
      color.rgb = mix(color.rgb, vec3(1.0, 0.72, 0.15), aligngsGlow.z) + 0.15 * aligngsGlow.z;
    }
    color.a *= inside(dot(center.xz, aligngsBox0.xy), aligngsBox0.z, aligngsBox0.w) * inside(center.y, aligngsBox1.x, aligngsBox1.y)
      * inside(dot(center.xz, aligngsBox2.xy), aligngsBox2.z, aligngsBox2.w);
    if (own.a > 0.25 && own.a < 0.75) color.rgb = mix(color.rgb, vec3(0.2, 0.85, 1.0), 0.6) + 0.1;
  }`;

export class SplatLayer {
  readonly entity = new Entity('splats');
  readonly splats: Splats;
  private resource: GSplatResource;
  private hidden = new Set<string>();
  private marked: Uint8Array | null = null;

  constructor(device: GraphicsDevice, parent: Entity, columns: Columns, styles: Texture) {
    const properties = [...columns.values].filter(([name]) => !['label', 'instance', 'confidence'].includes(name))
      .map(([name, storage]) => ({ type: 'float', name, storage, byteSize: 4 }));
    this.resource = new GSplatResource(device, new GSplatData([{ name: 'vertex', count: columns.count, properties }] as never));
    this.splats = splatsOf(columns);
    parent.addChild(this.entity); // textures of a component exist only in the scene
    this.entity.addComponent('gsplat', { resource: this.resource });
    this.attach(styles);
  }

  /// Draws with changed styles.
  update(): void { this.entity.gsplat!.workBufferUpdate = WORKBUFFER_UPDATE_ONCE; }

  destroy(): void {
    this.entity.destroy();
    this.resource.destroy();
  }

  /// Lets one object glow; null: none.
  glow(which: { label: number; instance: number } | null, strength: number): void {
    this.set('aligngsGlow', which ? [which.label, which.instance > 0 ? which.instance : -1, strength, 0] : [-9, -1, 0, 0]);
  }

  /// Draws one object at another place; null: all are where they are.
  move(which: { label: number; instance: number } | null, shift: number[]): void {
    this.set('aligngsMoved', which ? [which.label, which.instance > 0 ? which.instance : -1, 0, 0] : [-9, -1, 0, 0]);
    this.set('aligngsShift', shift);
  }

  /// Cuts away the sides of the room that are in the way, at most three.
  cut(sides: Cut[], wall: number): void {
    if (!this.splats.labels) return; // nothing is known to be a wall
    for (let k = 0; k < kCuts; ++k) {
      const side = sides[k];
      this.set(`aligngsCut${k}`, side ? [side.normal.x, side.normal.y, side.normal.z, side.offset] : kNoCut);
    }
    this.set('aligngsWall', wall);
  }

  /// Draws what is in a box alone; null: everything.
  box(b: CutBounds | null): void {
    const level = (k: number) => (b ? [b.axes[k].x, b.axes[k].z, b.low[k], b.high[k]] : kWholeSide);
    this.set('aligngsBox0', level(0));
    this.set('aligngsBox1', b ? [b.low[1], b.high[1], 0, 0] : [-1e3, 1e3, 0, 0]);
    this.set('aligngsBox2', level(2));
  }

  /// Shows or hides single objects.
  showObjects(hidden: Set<string>): void {
    this.hidden = hidden;
    this.writeStates();
  }

  /// Marks splats, one flag each; null: none.
  mark(flags: Uint8Array | null): void {
    this.marked = flags;
    this.writeStates();
  }

  private writeStates(): void {
    const { labels, instances, count } = this.splats, { hidden, marked } = this;
    const texture = this.entity.gsplat!.getInstanceTexture('splatLabel')!, data = texture.lock() as Uint8Array;
    for (let i = 0; i < count; ++i) {
      const gone = hidden.size > 0 && labels && hidden.has(objectKey(labels[i], instances ? instances[i] : 0));
      data[4 * i + 3] = gone ? kHidden : marked?.[i] ? kMarked : kPlain;
    }
    texture.unlock();
    this.update();
  }

  private set(name: string, value: number | number[]): void {
    this.entity.gsplat!.setParameter(name, value);
    this.update();
  }

  private attach(styles: Texture): void {
    this.resource.format.addExtraStreams([{ name: 'splatLabel', format: PIXELFORMAT_RGBA8, storage: GSPLAT_STREAM_INSTANCE }]);
    const texture = this.entity.gsplat!.getInstanceTexture('splatLabel')!, { labels, instances, count } = this.splats;
    const data = texture.lock() as Uint8Array;
    for (let i = 0; i < count; ++i) {
      const instance = instances ? instances[i] : 0, label = labels ? labels[i] : kStyles - 1;
      data[4 * i] = Math.min(kStyles - 1, label);
      data[4 * i + 1] = instance & 255;
      data[4 * i + 2] = instance >> 8;
      data[4 * i + 3] = kPlain;
    }
    texture.unlock();
    this.entity.gsplat!.setParameter('aligngsStyle', styles as unknown as number);
    this.glow(null, 0);
    this.move(null, [0, 0, 0]);
    this.cut([], 1);
    for (let k = 0; k < kCuts; ++k) this.set(`aligngsCut${k}`, kNoCut);
    this.set('aligngsWall', 1);
    this.box(null);
    this.entity.gsplat!.setWorkBufferModifier({ glsl: kModifier } as never);
  }
}

/// Data for picking.
function splatsOf(columns: Columns): Splats {
  const n = columns.count, column = (name: string) => columns.values.get(name);
  const interleaved = (names: string[], map: (v: number) => number) => {
    const out = new Float32Array(n * names.length);
    names.forEach((name, k) => {
      const values = column(name)!;
      for (let i = 0; i < n; ++i) out[i * names.length + k] = map(values[i]);
    });
    return out;
  };
  const rotations = interleaved(['rot_0', 'rot_1', 'rot_2', 'rot_3'], (v) => v);
  for (let i = 0; i < n; ++i) {
    const l = Math.hypot(rotations[4 * i], rotations[4 * i + 1], rotations[4 * i + 2], rotations[4 * i + 3]) || 1;
    for (let k = 0; k < 4; ++k) rotations[4 * i + k] /= l;
  }
  const labels = column('label'), instances = column('instance'), confidences = column('confidence');
  return {
    count: n, centres: interleaved(['x', 'y', 'z'], (v) => v), scales: interleaved(['scale_0', 'scale_1', 'scale_2'], Math.exp), rotations,
    opacities: interleaved(['opacity'], (v) => 1 / (1 + Math.exp(-v))),
    labels: labels ? Uint16Array.from(labels) : null, instances: instances ? Uint16Array.from(instances) : null,
    confidences: confidences ? Uint8Array.from(confidences) : null, places: columns.places ?? null, total: columns.total ?? n,
  };
}
