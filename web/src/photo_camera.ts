// The camera at the place of a photo.
import { Vec3 } from 'playcanvas';
import { type CameraInfo } from './api';
import { type Viewer } from './viewer';

/// Puts the camera where a photo was taken, with its field of view; returns the part of the canvas that the photo fills.
export function lookThrough(viewer: Viewer, c: CameraInfo): { width: number; height: number } {
  const R = c.rotation, turn = viewer.world.getRotation();
  const axis = (k: number, sign: number) => turn.transformVector(new Vec3(sign * R[0][k], sign * R[1][k], sign * R[2][k]));
  const eye = viewer.toWorld(c.position);
  viewer.camera.setPosition(eye);
  viewer.camera.lookAt(eye.clone().add(axis(2, 1)), axis(1, -1));
  const w = viewer.canvas.clientWidth, h = viewer.canvas.clientHeight, scale = Math.min(w / c.width, h / c.height);
  viewer.camera.camera!.fov = (2 * Math.atan((0.5 * h) / (c.fy * scale)) * 180) / Math.PI;
  viewer.moved();
  return { width: c.width * scale, height: c.height * scale };
}
