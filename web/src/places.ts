// Ways of the camera: to the start pose, a link, an object, a place of the plan.
import { Vec3 } from 'playcanvas';
import { cutOf } from './cut_box';
import { element } from './dom';
import { type Mode, type Pose } from './navigation';
import { type Page } from './page';
import { poseOf } from './saved_views';
import { type SceneObject } from './scene_objects';
import { homeOf, poseBefore } from './start_pose';

const kFieldOfView = 62, kUprightFieldOfView = 80; // degrees, vertical; the second for a phone held upright

export class Places {
  private home: Pose | null = null; // stays the same while more splats come

  constructor(private page: Page) {}

  /// Looks from where the address says, and cuts the room as it says.
  followLink(): void {
    const pose = poseOf(location.hash);
    if (!pose) return;
    this.page.cut.set(cutOf(location.hash));
    this.look(pose.eye, pose.target);
  }

  start(): void {
    this.home ??= homeOf(this.page.viewer, this.page.state);
    this.look(this.home.eye, this.home.target);
  }

  /// Leaves the place of a photo and looks from here.
  look(eye: Vec3, target: Vec3): void {
    this.page.comparison.end();
    this.page.navigation.enabled = true;
    const { canvas } = this.page.viewer;
    this.page.viewer.camera.camera!.fov = canvas.clientWidth < canvas.clientHeight ? kUprightFieldOfView : kFieldOfView;
    this.page.navigation.lookFrom(eye, target);
  }

  flyTo(object: SceneObject): void {
    const { eye, target } = poseBefore(this.page.viewer, object);
    this.look(eye, target);
    this.page.selection.choose(object);
  }

  /// Goes to a place of the plan, as high as before.
  goTo(place: (height: number) => number[]): void {
    const { eye, target } = this.page.navigation.pose, at = this.page.viewer.toWorld(place(0));
    const move = new Vec3(at.x - eye.x, 0, at.z - eye.z);
    this.setMode('walk');
    this.look(eye.clone().add(move), target.clone().add(move));
  }

  markPlan(): void {
    const { eye, target } = this.page.navigation.pose;
    this.page.plan.mark(this.page.viewer.fromWorld(eye, true), this.page.viewer.fromWorld(target.sub(eye), false));
  }

  setMode(mode: Mode): void {
    this.page.navigation.setMode(mode);
    element('walk').setAttribute('aria-pressed', String(mode === 'walk'));
    element('stick').hidden = mode !== 'walk';
  }
}
