// The camera of the page, for its camera paths.
import { type Page } from './page';
import { type PathCamera } from './path_panel';

export function pathCamera(page: Page): PathCamera {
  const { viewer } = page;
  return {
    get: () => {
      const { eye, target } = page.navigation.pose;
      return { eye: viewer.fromWorld(eye, true), target: viewer.fromWorld(target, true), fov: viewer.camera.camera!.fov };
    },
    show: (key) => viewer.lookFrom(viewer.toWorld(key.eye), viewer.toWorld(key.target), key.fov),
    begin: () => { page.comparison.end(); page.selection.clear(); page.navigation.enabled = false; },
    end: (key) => { page.places.look(viewer.toWorld(key.eye), viewer.toWorld(key.target)); viewer.lookFrom(viewer.toWorld(key.eye), viewer.toWorld(key.target), key.fov); },
  };
}
