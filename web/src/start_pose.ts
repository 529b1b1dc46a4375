// The poses that the camera begins with, and in front of one object.
import { Vec3 } from 'playcanvas';
import { type CameraInfo, type RunState } from './api';
import { type Pose } from './navigation';
import { type SceneObject } from './scene_objects';
import { type Viewer } from './viewer';

const kFlyDistance = 2.2;  // of an object's size, from where it is looked at

/// Photos are held upright: the mean of the cameras' up directions, in the scene's own axes.
export function upOf(cameras: CameraInfo[]): Vec3 {
  const sum = new Vec3(0, 0, 0);
  for (const c of cameras) sum.add(new Vec3(-c.rotation[0][1], -c.rotation[1][1], -c.rotation[2][1]));
  return sum.length() > 1e-6 ? sum.normalize() : new Vec3(0, -1, 0);
}

/// The server's start pose of the room (src/serve/start_pose.h), else from the photo's place farthest from the middle.
export function homeOf(viewer: Viewer, state: RunState): Pose {
  const { room } = viewer;
  if (state.start) {
    const eye = viewer.toWorld(state.start.eye), target = viewer.toWorld(state.start.target);
    return { eye, target: room ? room.nearer(eye, target) : target };
  }
  const target = viewer.middle();
  let eye = target.clone().add(new Vec3(0, 1, 3)), farthest = 0;
  for (const c of state.cameras ?? []) {
    const p = viewer.toWorld(c.position), d = p.distance(target);
    if (d > farthest) { farthest = d; eye = p; }
  }
  return { eye: room && farthest > 0 ? room.inside(eye, 0) : eye, target };
}

/// At an object from the middle of the room, or from above if it is there.
export function poseBefore(viewer: Viewer, object: SceneObject): Pose {
  const away = new Vec3().sub2(viewer.middle(), object.centre);
  away.y = Math.max(0.3 * away.length(), 0.3 * object.size.length());
  const distance = kFlyDistance * Math.max(0.2, object.size.length());
  const eye = object.centre.clone().add(away.normalize().mulScalar(distance));
  return { eye: viewer.room ? viewer.room.inside(eye, 0.1) : eye, target: object.centre };
}
