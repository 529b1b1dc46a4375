// Edits in the page: by text and by click, previewed, undone, done again, exported; the same bytes as on the command line.
// Usage: node test/edit_test.mjs PROGRAM RUN [FOLDER_FOR_SCREENSHOTS]
import { cpSync, existsSync, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { aligngs, check, difference, open, remove, serve, settings, skip, withBrowser } from './browser.mjs';

const { program, run: given, shots, folder } = settings(), run = join(folder, 'page'), other = join(folder, 'command');
if (!given || !existsSync(given)) skip('no run was given');
for (const copy of [run, other]) cpSync(given, copy, { recursive: true, filter: (path) => !path.includes('/control') });
const { server, url } = await serve(program, run);
await withBrowser(async (browser) => {
  const { page, complaints, picture, shot, slide, message } = await open(browser, url, { shots, prefix: 'edit_', density: 0.5, width: 900, height: 520 });
  await page.waitForFunction(() => window.aligngs.page.edits.objects.length > 0, null, { timeout: 60000 });
  const start = await picture();
  await shot('start');
  const edits = () => page.locator('#edits li').allTextContents();
  const done = (count) => page.waitForFunction((n) => document.querySelectorAll('#edits li').length === n && !document.body.classList.contains('busy'),
    count, { timeout: 60000 });
  const splats = () => page.evaluate(() => window.aligngs.viewer.splats.count);
  const before = await splats();
  const names = await page.evaluate(() => [...new Set(window.aligngs.page.edits.objects.map((o) => o.object.replace(/#.*/, '')))]);
  const thing = names.includes('bed') ? 'bed' : names.find((n) => !['wall', 'floor', 'ceiling'].includes(n));

  await page.keyboard.press('/');
  await page.keyboard.type(`delete ${thing}`);
  await page.locator('#edit-preview').click();
  await page.waitForFunction(() => document.getElementById('preview').open, null, { timeout: 60000 });
  await page.locator('#preview-picture').evaluate((i) => i.decode());
  check((await page.locator('#preview-picture').evaluate((i) => i.naturalWidth)) > 100, 'a preview shows before and after');
  check((await page.locator('#preview-text').textContent()).includes('Gaussians'), 'and says how much is meant');
  check(!existsSync(join(run, 'edits.json')) && (await splats()) === before, 'and changes nothing');
  await shot('preview');
  await page.locator('#preview-apply').click();
  await done(1);
  check((await edits())[0] === `delete ${thing}, hole filled`, `the text box does what it says (${(await edits())[0]})`);
  check((await splats()) !== before, `${before} splats became ${await splats()}`); // the hole is filled: there may be more
  await page.mouse.move(2, 2); // what is under the pointer glows
  const deleted = await picture();
  check(!(await page.locator('#photo-before').evaluate((e) => e.hidden)), 'comparisons tell that the photo shows the room before');
  check(difference(start, deleted) > 1, 'and the picture changes');
  await shot('deleted');
  await page.locator('#original').click();
  const original = await picture();
  await shot('before_edits');
  check(difference(start, original) < 1, `"before edits" shows what was trained (${difference(start, original).toFixed(2)} levels)`);
  await page.locator('#original').click();
  const back = await picture();
  await shot('back');
  check(difference(deleted, back) < 1, `and back (${difference(deleted, back).toFixed(2)} levels)`);

  await page.locator('#undo').click();
  await done(0);
  check(difference(start, await picture()) < 1 && (await splats()) === before, 'undo brings the room back');
  check(await page.locator('#photo-before').evaluate((e) => e.hidden), 'and the photo is of this room');
  await page.keyboard.press('y');
  await done(1);
  check(difference(deleted, await picture()) < 1, 'redo deletes again');

  const wall = page.locator('#classes li', { has: page.locator('.class-name', { hasText: /^wall$/ }) });
  await wall.locator('.recolor input').evaluate((e) => { e.value = '#ff8040'; e.dispatchEvent(new Event('change')); });
  await done(2);
  check((await edits())[1] === 'recolor wall to #ff8040', 'the class list recolours');
  check(difference(deleted, await picture()) > 3, 'and the wall has the colour');
  await shot('recoloured');
  aligngs(program, 'edit', other, '-q', '--select', thing, '--delete', '--fill');
  aligngs(program, 'edit', other, '-q', '--select', 'wall', '--recolor', '#ff8040');
  for (const file of ['edits.json', ...readdirSync(join(run, 'edits')).map((name) => `edits/${name}`)]) {
    check(readFileSync(join(run, file)).equals(readFileSync(join(other, file))), `${file} is that of the command line`);
  }

  // A click on whatever is in the middle, then its buttons.
  const box = await page.locator('#canvas').boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  const picked = await page.locator('#picked-text').textContent();
  check(/^.+: object \d+, .*\d+ % of the ray, confidence /.test(picked), `a click says what it is (${picked})`);
  await shot('picked');
  await page.locator('#picked-edits button[data-edit="highlight"]').click();
  await done(3);
  check((await edits())[2].startsWith(`highlight ${picked.split(':')[0]}#`), `its button highlights that object (${(await edits())[2]})`);
  await page.keyboard.press('z');
  await done(2);
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await page.locator('#picked-edits button[data-edit="extract"]').click();
  await done(3);
  const rest = await picture();
  check((await edits())[2].startsWith('extract '), 'and extracts it');
  await shot('extracted');
  await page.locator('#undo').click();
  await done(2);

  await page.locator('#edit-text').fill('delete bedd');
  await page.locator('#edit-text').press('Enter');
  await page.waitForFunction(() => document.getElementById('message').textContent.includes('did you mean'), null, { timeout: 60000 });
  check(/did you mean "delete bed"/.test(await message()), `a typing error is answered (${await message()})`);
  check((await edits()).length === 2, 'and changes nothing');

  for (const format of ['glb', 'html']) {
    await page.locator('#export-format').selectOption(format);
    const save = async () => {
      await page.locator('#export').click();
      if (format === 'html') await page.locator('#export-save').click(); // the dialog with the size
    };
    const [download] = await Promise.all([page.waitForEvent('download', { timeout: 60000 }), save()]);
    check(download.suggestedFilename() === `scene.edited.${format}`, `saves ${download.suggestedFilename()}`);
    check(readFileSync(await download.path()).equals(readFileSync(join(run, `scene.edited.${format}`))), 'as it stands in the run folder');
    await page.waitForFunction(() => !document.body.classList.contains('busy'));
  }

  // Several edits go at once, and come back one by one.
  const type = async (text, count) => { await page.locator('#edit-text').fill(text); await page.locator('#edit-text').press('Enter'); await done(count); };
  await type('highlight floor in orange', 3);
  await type('undo the last two edits', 1);
  check((await edits()).join() === `delete ${thing}, hole filled`, `the last two go (${(await edits()).join()})`);
  check(/undone: highlight .*; recolor wall /.test(await message()), `and are named (${await message()})`);
  await page.mouse.move(2, 2);
  check(difference(deleted, await picture()) < 1, 'the picture is that of the first edit');
  await page.locator('#redo').click();
  await done(2);
  check((await edits())[1] === 'recolor wall to #ff8040', `"again" brings back the older one first (${(await edits())[1]})`);
  await type('undo everything', 0);
  await page.mouse.move(2, 2);
  check(difference(start, await picture()) < 1 && (await splats()) === before, '"undo everything" brings the room back');
  check(!existsSync(join(run, 'edits')), 'and leaves no files of edits');

  // An object that leaves the room is named before and after.
  const warned = new RegExp(`warning: ${thing}.* reaches .* (into a wall|out of the room)`);
  await page.locator('#edit-text').fill(`move ${thing} 9 m to the left`);
  await page.locator('#edit-preview').click();
  await page.waitForFunction(() => document.getElementById('preview').open, null, { timeout: 60000 });
  const foretold = await page.locator('#preview-text').textContent();
  check(warned.test(foretold), `a preview warns of a move through the wall (${foretold})`);
  await page.locator('#preview-apply').click();
  await done(1);
  check(warned.test(await message()), `and so does the move (${await message()})`);
  await page.locator('#undo').click();
  await done(0);

  // Things on the object are asked for.
  if (thing === 'bed') {
    await type('delete bed', 1);
    const ask = page.locator('#message-action');
    await ask.waitFor({ state: 'visible', timeout: 60000 });
    check(/left behind: .*#1/.test(await message()), `what was on the bed is named (${await message()})`);
    await shot('asked');
    await ask.click();
    await page.waitForFunction(() => document.querySelector('#edits li')?.textContent.includes('with contents') && !document.body.classList.contains('busy'), null, { timeout: 60000 });
    check((await edits()).join() === 'delete bed with contents, hole filled', 'and goes along when asked to');
    check(await ask.isHidden(), 'and is asked for once');
    await page.locator('#undo').click();
    await done(0);
  }
  const expected = (c) => c.includes('400'); // the typing error
  check(rest.length > 0 && complaints.filter((c) => !expected(c)).length === 0, `no errors in the console ${complaints.slice(0, 3).join(' | ')}`);
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
