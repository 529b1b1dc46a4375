// How many pixels are drawn while the camera moves: as many as the graphics unit draws in time.
const kLevels = [1, 0.6, 0.33];        // of the pixels in each direction
const kTooSlow = [40, 120];            // milliseconds a frame at a level: the next one is taken
const kFast = 12;                      // milliseconds a frame: the level before is tried again
const kPause = 5000;                   // milliseconds: more is a rest between two movements and no frame
const kRest = 200, kSlowRest = 2;      // milliseconds of rest, and in frames where those take long
const kWeight = 0.5;                   // of the newest frame in the mean

export class MovingQuality {
  level = 0; // 0: everything is drawn while the camera moves, too
  private mean = 0; // milliseconds a frame at this level; 0: none was seen
  private took = 0; // milliseconds of the last frame
  private last = 0; // time of the last frame, 0: the camera has just begun to move

  get share(): number { return kLevels[this.level]; }
  /// Milliseconds without a move that are a rest, and no slow picture.
  get patience(): number { return Math.max(kRest, kSlowRest * this.took); }

  /// A frame was drawn while the camera moves.
  frame(now: number): void {
    const took = now - this.last;
    const first = this.last === 0 || took > kPause;
    this.last = now;
    if (first) return;
    this.took = took;
    this.mean = this.mean === 0 ? took : kWeight * took + (1 - kWeight) * this.mean;
    if (this.level < kTooSlow.length && this.mean > kTooSlow[this.level]) this.change(1);
    else if (this.level > 0 && this.mean < kFast) this.change(-1);
  }
  rest(): void { this.last = 0; }

  private change(by: number): void {
    this.level += by;
    this.mean = 0;
  }
}
