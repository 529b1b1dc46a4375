// The camera as the splats see it.
import { type SplatView } from './front_depth';
import { type CullView } from './splat_cull';
import { type Viewer } from './viewer';

export function splatViewOf(viewer: Viewer): SplatView {
  const { camera, canvas } = viewer, axis = (v: typeof camera.right) => viewer.fromWorld(v, false);
  const height = canvas.clientHeight, focal = height / 2 / Math.tan((camera.camera!.fov * Math.PI) / 360);
  return {
    eye: viewer.fromWorld(camera.getPosition(), true), right: axis(camera.right), down: axis(camera.up).map((x) => -x), forward: axis(camera.forward),
    focal, width: canvas.clientWidth, height,
  };
}

/// With the pixels that are drawn now.
export function cullViewOf(viewer: Viewer): CullView {
  const { eye, right, down, forward } = splatViewOf(viewer), { width, height } = viewer.app.graphicsDevice, { gsplat } = viewer.app.scene;
  const tanY = Math.tan((viewer.camera.camera!.fov * Math.PI) / 360);
  return { eye, right, down, forward, tanX: (tanY * width) / height, tanY, focal: height / tanY, leastSize: gsplat.minPixelSize, leastAlpha: gsplat.alphaClipForward };
}
