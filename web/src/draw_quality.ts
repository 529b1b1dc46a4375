// How well the room is drawn: fewer pixels and no faint splats while the camera moves, everything when it rests.
import { type AppBase } from 'playcanvas';
import { MovingQuality } from './moving_quality';
import { kLeastAlpha } from './pick';

const kMostPixelRatio = 1.5;     // device pixels a CSS pixel: more is not seen and costs time
// By the level of MovingQuality; the first is that of a resting camera.
const kLeastAlphas = [kLeastAlpha, 1 / 32, 1 / 12]; // opacity below which a splat is not drawn
const kLeastSizes = [2, 4, 4];     // half pixels below which a splat is not drawn
const kColorAngles = [10, 20, 45]; // degrees until the colours of splats are made anew, which their harmonics change

export const pixelRatio = (): number => Math.min(window.devicePixelRatio, kMostPixelRatio);

export class DrawQuality {
  moves = false; // the camera moves, or has just moved
  private sharp = 0; // timer: the full quality comes back
  private quality = new MovingQuality();
  private frames = 0;
  private framesBefore = 0; // frames when the camera moved last

  /// `held`: a pointer or a key moves the camera now. `resized` gives the canvas its pixels. `rests` draws at full quality.
  constructor(private app: AppBase, private held: () => boolean, private resized: () => void, private rests: () => void) {}

  /// A picture is drawn.
  frame(): void {
    ++this.frames;
    if (this.moves) this.quality.frame(performance.now());
  }

  moved(): void {
    this.set(true);
    this.framesBefore = this.frames;
    this.restAgain();
  }

  /// The full quality comes back when the camera rests; a slow picture is no rest.
  private restAgain(): void {
    window.clearTimeout(this.sharp);
    this.sharp = window.setTimeout(() => {
      if (this.held() || this.frames === this.framesBefore) { this.restAgain(); return; }
      this.set(false);
      this.rests();
    }, this.quality.patience);
  }

  set(moving: boolean): void {
    const { gsplat } = this.app.scene, level = moving ? this.quality.level : 0;
    gsplat.alphaClipForward = kLeastAlphas[level];
    gsplat.minPixelSize = kLeastSizes[level];
    gsplat.colorUpdateAngle = kColorAngles[level];
    if (!moving) this.quality.rest();
    this.moves = moving;
    const device = this.app.graphicsDevice, ratio = (moving ? this.quality.share : 1) * pixelRatio();
    if (device.maxPixelRatio === ratio) return;
    device.maxPixelRatio = ratio;
    this.resized();
  }
}
