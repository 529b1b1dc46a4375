// The box that cuts the room: six sliders along its walls, floor and ceiling. The outside is neither drawn nor under
// the pointer.
import { Color, type Vec3 } from 'playcanvas';
import { element } from './dom';
import { type RoomBox } from './room_box';
import { type Line } from './scene_lines';

/// Shares of the room's sides, from and to for each of its axes (across, up, along); 0 and 1: all of it.
export type CutShares = [number, number, number, number, number, number];
/// In the y-up world: dot(position, axis) is from low to high.
export interface CutBounds { axes: Vec3[]; low: number[]; high: number[] }

const kSliders = ['cut-left', 'cut-right', 'cut-bottom', 'cut-top', 'cut-front', 'cut-back'];
const kWhole: CutShares = [0, 1, 0, 1, 0, 1];
const kSteps = 100;          // of a slider
const kLeastShare = 0.02;    // between two sides
const kBeyond = 1e3;         // scene units: a side that cuts nothing away
const kColor = new Color(0.2, 0.85, 1);

export class CutBox {
  private shares: CutShares = [...kWhole];

  constructor(private changed: () => void) {
    kSliders.forEach((id, k) => element(id).addEventListener('input', () => this.slid(k)));
    element('cut-reset').addEventListener('click', () => this.set(null));
  }

  /// null: nothing is cut away.
  get(): CutShares | null { return this.shares.some((s, k) => s !== kWhole[k]) ? this.shares : null; }

  set(shares: CutShares | null): void {
    this.shares = [...(shares ?? kWhole)];
    this.show();
    this.changed();
  }

  bounds(room: RoomBox | null): CutBounds | null {
    if (!room || !this.get()) return null;
    const at = (k: number, side: number) => room.low[k] + this.shares[2 * k + side] * (room.high[k] - room.low[k]);
    return {
      axes: room.axes, low: [0, 1, 2].map((k) => (this.shares[2 * k] === 0 ? -kBeyond : at(k, 0))),
      high: [0, 1, 2].map((k) => (this.shares[2 * k + 1] === 1 ? kBeyond : at(k, 1))),
    };
  }

  /// The edges of the box.
  lines(room: RoomBox | null): Line[] {
    if (!room || !this.get()) return [];
    const corner = (bits: number) => room.axes.map((axis, k) => {
      const share = this.shares[2 * k + ((bits >> k) & 1)];
      return axis.clone().mulScalar(room.low[k] + share * (room.high[k] - room.low[k]));
    }).reduce((sum, v) => sum.add(v));
    const points: Vec3[] = [];
    for (let bits = 0; bits < 8; ++bits) for (let k = 0; k < 3; ++k) if (!((bits >> k) & 1)) points.push(corner(bits), corner(bits | (1 << k)));
    return [{ points, color: kColor }];
  }

  /// A slider was moved; it pushes the opposite side before it.
  private slid(k: number): void {
    const value = Number(element<HTMLInputElement>(kSliders[k]).value) / kSteps, shares = this.shares, other = k ^ 1;
    shares[k] = k % 2 === 0 ? Math.min(value, 1 - kLeastShare) : Math.max(value, kLeastShare);
    if (shares[k & ~1] > shares[k | 1] - kLeastShare) shares[other] = shares[k] + (k % 2 === 0 ? kLeastShare : -kLeastShare);
    this.show();
    this.changed();
  }

  private show(): void {
    kSliders.forEach((id, k) => { element<HTMLInputElement>(id).value = String(Math.round(this.shares[k] * kSteps)); });
    element<HTMLButtonElement>('cut-reset').disabled = !this.get();
  }
}

/// "cut=0,1,0,0.5,0,1", or nothing.
export const cutText = (shares: CutShares | null): string => (shares ? `cut=${shares.map((s) => Number(s.toFixed(2))).join(',')}` : '');

/// The shares of an address; null when it has none that are whole.
export function cutOf(hash: string): CutShares | null {
  const text = new URLSearchParams(hash.replace(/^#/, '')).get('cut') ?? '', values = text.split(',').map(Number);
  const good = text !== '' && values.length === 6 && values.every((v) => v >= 0 && v <= 1) && [0, 2, 4].every((k) => values[k] < values[k + 1]);
  return good ? (values as CutShares) : null;
}
