// Shapes that are drawn over the picture: rectangle, lasso, stroke of a brush; and the splats that they take.
import { FrontDepth, projected, type Region, type SplatView } from './front_depth';
import { kLeastAlpha, type Splats } from './pick';

export type Tool = 'rectangle' | 'lasso' | 'brush';
export interface Point { x: number; y: number } // CSS pixels of the canvas
export interface Shape { box: Region; has(x: number, y: number): boolean }

const boxOf = (points: Point[], margin: number): Region => ({
  left: Math.min(...points.map((p) => p.x)) - margin, right: Math.max(...points.map((p) => p.x)) + margin,
  top: Math.min(...points.map((p) => p.y)) - margin, bottom: Math.max(...points.map((p) => p.y)) + margin,
});

/// The shape of the points that a pointer went through; `radius`: of the brush, CSS pixels.
export function shapeOf(tool: Tool, points: Point[], radius: number): Shape {
  if (tool === 'rectangle') {
    const box = boxOf([points[0], points[points.length - 1]], 0);
    return { box, has: (x, y) => x >= box.left && x <= box.right && y >= box.top && y <= box.bottom };
  }
  if (tool === 'lasso') return { box: boxOf(points, 0), has: (x, y) => isInside(points, x, y) };
  return { box: boxOf(points, radius), has: (x, y) => isNear(points, x, y, radius) };
}

/// Even-odd rule; the last point is joined with the first.
function isInside(points: Point[], x: number, y: number): boolean {
  let inside = false;
  for (let i = 0, j = points.length - 1; i < points.length; j = i++) {
    const a = points[i], b = points[j];
    if (a.y > y !== b.y > y && x < a.x + ((b.x - a.x) * (y - a.y)) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

function isNear(points: Point[], x: number, y: number, radius: number): boolean {
  for (let i = 0; i < points.length; ++i) {
    const a = points[Math.max(0, i - 1)], b = points[i], dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
    const t = length2 > 0 ? Math.max(0, Math.min(1, ((x - a.x) * dx + (y - a.y) * dy) / length2)) : 0;
    if ((x - a.x - t * dx) ** 2 + (y - a.y - t * dy) ** 2 <= radius * radius) return true;
  }
  return false;
}

/// Splats whose centre is in the shape. With a `skin` (scene units) only those in front of the first surface there, and
/// at most that deep in it; null: all of them.
export function splatsIn(s: Splats, drawn: (splat: number) => boolean, view: SplatView, shape: Shape, skin: number | null): number[] {
  const region = { left: Math.max(0, shape.box.left), top: Math.max(0, shape.box.top), right: Math.min(view.width, shape.box.right), bottom: Math.min(view.height, shape.box.bottom) };
  if (region.right <= region.left || region.bottom <= region.top) return [];
  const front = skin === null ? null : FrontDepth.of(s, drawn, view, region), found: number[] = [];
  for (let i = 0; i < s.count; ++i) {
    if (s.opacities[i] < kLeastAlpha) continue;
    const p = projected(s, i, view);
    if (!p || p.x < region.left || p.x >= region.right || p.y < region.top || p.y >= region.bottom || !shape.has(p.x, p.y) || !drawn(i)) continue;
    if (!front || p.depth <= front.at(p.x, p.y) + skin!) found.push(i);
  }
  return found;
}
