// The view at a size of its own, as a PNG file.
import { RESOLUTION_AUTO, RESOLUTION_FIXED } from 'playcanvas';
import { type Viewer } from './viewer';

const kPictureTime = 30000; // milliseconds that a picture of a chosen size may take

/// The screen shows afterwards what it showed before.
export async function pictureOf(viewer: Viewer, width: number, height: number): Promise<Blob> {
  const { app, canvas } = viewer;
  try {
    viewer.quality.set(false);
    app.setCanvasResolution(RESOLUTION_FIXED, width, height);
    app.graphicsDevice.setResolution(width, height); // whatever the pixels of the screen are
    for (const end = performance.now() + kPictureTime; ;) {
      viewer.draw();
      await new Promise(requestAnimationFrame);
      await new Promise(requestAnimationFrame);
      if (viewer.showsMesh || viewer.settled) break;
      if (performance.now() > end) throw new Error('The picture does not come to rest. Try again without moving the camera.');
    }
    const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, 'image/png'));
    if (!blob || canvas.width !== width || canvas.height !== height) throw new Error(`This browser cannot draw ${width} × ${height} pixels.`);
    return blob;
  } finally {
    app.setCanvasResolution(RESOLUTION_AUTO);
    viewer.resize();
    viewer.draw();
  }
}
