// The view as a PNG file at a chosen size.
import { element } from './dom';
import { type Messages } from './messages';
import { offer } from './path_panel';
import { pictureOf } from './view_picture';
import { type Viewer } from './viewer';

/// "1920x1080" of the list, or the size of the canvas.
function sizeOf(text: string, canvas: HTMLCanvasElement): { width: number; height: number } {
  const [width, height] = text.split('x').map(Number);
  return height > 0 ? { width, height } : { width: canvas.width, height: canvas.height };
}

export function bindPicture(viewer: Viewer, messages: Messages): void {
  const button = element<HTMLButtonElement>('picture-save');
  button.addEventListener('click', async () => {
    const { width, height } = sizeOf(element<HTMLSelectElement>('picture-size').value, viewer.canvas);
    button.disabled = true;
    messages.show('drawing the picture', 'work');
    try {
      offer(await pictureOf(viewer, width, height), `view_${width}x${height}.png`);
      messages.show(`The picture has ${width} × ${height} pixels.`);
    } catch (e) {
      messages.error(e);
    } finally {
      button.disabled = false;
    }
  });
}
