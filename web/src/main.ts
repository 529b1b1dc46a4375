// The page of `aligngs view`.
import { fetchAhead } from './api';
import { element } from './dom';
import { Messages } from './messages';
import { Page } from './page';
import { Viewer } from './viewer';

async function main(): Promise<void> {
  try {
    fetchAhead(); // while the graphics unit is being opened, which takes most of the time to the first picture
    await (window as unknown as { aligngsBegun: Promise<void> }).aligngsBegun; // start.ts
    const viewer = await Viewer.create(element<HTMLCanvasElement>('canvas'));
    const page = new Page(viewer);
    (window as unknown as Record<string, unknown>).aligngs = { viewer, page, ready: page.start().then(() => true) };
    await (window as unknown as { aligngs: { ready: Promise<boolean> } }).aligngs.ready;
  } catch (error) {
    new Messages().show(`The scene cannot be shown. ${error instanceof Error ? error.message : String(error)}`, 'error');
    throw error;
  }
}

void main();
