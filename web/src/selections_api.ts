// Requests about selections by hand (src/serve/selection_service.h).
import { post, refusal, request } from './api';

export interface NamedSelection { name: string; gaussians: number; usable: boolean }
interface Answer { selections: NamedSelection[] }

const kLongestRequest = 60000; // bytes of places as text: a body has at most 64 KiB

const path = (parts: string): string => parts.split('/').map(encodeURIComponent).join('/');

export async function fetchSelections(): Promise<NamedSelection[]> {
  const answer = await request('/api/selections');
  if (!answer.ok) throw await refusal(answer);
  return (await answer.json() as Answer).selections;
}

/// `flags`: one per splat of the trained scene in `scene`.
export async function saveSelection(name: string, scene: string, flags: Uint8Array): Promise<NamedSelection[]> {
  const bits = new Uint8Array(Math.ceil(flags.length / 8));
  flags.forEach((on, i) => { if (on) bits[i >> 3] |= 1 << (i & 7); });
  const stream = new Blob([bits]).stream().pipeThrough(new CompressionStream('gzip'));
  const packed = new Uint8Array(await new Response(stream).arrayBuffer());
  let text = '';
  for (const byte of packed) text += String.fromCharCode(byte);
  const places = btoa(text);
  if (places.length > kLongestRequest) throw new Error('The selection has too many scattered pieces. Select a smaller part of the room.');
  return (await post<Answer>('/api/selections/save', { name, scene, splats: String(flags.length), places })).selections;
}

export const renameSelection = async (name: string, to: string): Promise<NamedSelection[]> => (await post<Answer>('/api/selections/rename', { name, to })).selections;
export const removeSelection = async (name: string): Promise<NamedSelection[]> => (await post<Answer>('/api/selections/remove', { name })).selections;

/// The flags of a selection, one per splat of the trained scene.
export async function fetchPlaces(name: string, scene: string, splats: number): Promise<Uint8Array<ArrayBuffer>> {
  const answer = await request(`/api/selections/places/${path(`${name}/${scene}`)}`);
  if (!answer.ok) throw await refusal(answer);
  const stream = (await answer.blob()).stream().pipeThrough(new DecompressionStream('gzip'));
  const bits = new Uint8Array(await new Response(stream).arrayBuffer());
  return Uint8Array.from({ length: splats }, (_, i) => (bits[i >> 3] >> (i & 7)) & 1);
}
