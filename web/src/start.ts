// Runs before the page's script is there.
import { kContext } from './webgl_context';

(document.getElementById('canvas') as HTMLCanvasElement).getContext('webgl2', kContext);
