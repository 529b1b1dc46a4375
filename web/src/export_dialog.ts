// The export of the page as one file: its size, and what it holds, before it is written.
import { post } from './api';
import { element } from './dom';

/// Bytes by part (HtmlSize in src/serve/html_export.h).
interface Sizes { page: number; splats: number; mesh: number; before: number; before_mesh: number }

const megabytes = (bytes: number): string => `${(bytes / 1e6).toFixed(1)} MB`;

/// Asks what the file is to hold. The answer lists the parts to leave out, "mesh,before"; null: no file.
export async function askHtmlExport(): Promise<string | null> {
  const sizes = await post<Sizes>('/api/export/size', { format: 'html' });
  const dialog = element<HTMLDialogElement>('export-dialog'), mesh = element<HTMLInputElement>('export-mesh'), before = element<HTMLInputElement>('export-before');
  element('export-mesh-row').hidden = sizes.mesh === 0;
  element('export-before-row').hidden = sizes.before === 0;
  const tell = () => {
    const withMesh = mesh.checked ? 1 : 0, withBefore = before.checked ? 1 : 0;
    const total = sizes.page + sizes.splats + withMesh * sizes.mesh + withBefore * (sizes.before + withMesh * sizes.before_mesh);
    element('export-size').textContent = `about ${megabytes(total)}`;
  };
  mesh.onchange = before.onchange = tell;
  tell();
  dialog.returnValue = '';
  dialog.showModal();
  await new Promise((closed) => dialog.addEventListener('close', closed, { once: true }));
  if (dialog.returnValue !== 'save') return null;
  return [...(mesh.checked ? [] : ['mesh']), ...(before.checked ? [] : ['before'])].join(',');
}
