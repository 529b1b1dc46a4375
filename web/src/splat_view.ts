// The camera as the splats see it.
import { type SplatView } from './front_depth';
import { type Viewer } from './viewer';

export function splatViewOf(viewer: Viewer): SplatView {
  const { camera, canvas } = viewer, axis = (v: typeof camera.right) => viewer.fromWorld(v, false);
  const height = canvas.clientHeight, focal = height / 2 / Math.tan((camera.camera!.fov * Math.PI) / 360);
  return {
    eye: viewer.fromWorld(camera.getPosition(), true), right: axis(camera.right), down: axis(camera.up).map((x) => -x), forward: axis(camera.forward),
    focal, width: canvas.clientWidth, height,
  };
}
