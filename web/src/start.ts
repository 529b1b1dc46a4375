// Runs before the page's script is there.
import { kContext } from './webgl_context';

const kPatience = 150; // milliseconds that the graphics context waits for the first picture, and for its frame (a hidden page has none)

const canvas = document.getElementById('canvas') as HTMLCanvasElement, picture = document.getElementById('first-picture') as HTMLImageElement;
if (location.hash) picture.hidden = true; // a link looks from elsewhere

/// Opening a graphics context holds up everything else, so the first picture is to be seen before.
(window as unknown as Record<string, unknown>).aligngsBegun = Promise.race([
  picture.hidden ? null : picture.decode().catch(() => {}),
  new Promise((done) => window.setTimeout(done, kPatience)),
]).then(() => new Promise<void>((done) => { requestAnimationFrame(() => window.setTimeout(done)); window.setTimeout(done, kPatience); })).then(() => { canvas.getContext('webgl2', kContext); });
