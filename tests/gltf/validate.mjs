// Validates each *.glb of a folder; x.answer.glb against x.sent.glb or x.sent.gltf.
import {existsSync, readdirSync, readFileSync} from 'node:fs';
import {join} from 'node:path';
import validator from 'gltf-validator';

const folder = process.argv[2];
async function errors(file) {
    const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {maxIssues: 0});
    return report.issues.messages.filter(m => m.severity === 0)
        .map(m => `${m.code} ${m.pointer} ${m.message}`);
}

let files = 0, failed = 0;
for (const name of readdirSync(folder).filter(n => n.endsWith('.glb') && !n.endsWith('.sent.glb')).sort()) {
    const sent = ['glb', 'gltf'].map(e => join(folder, name.replace(/answer\.glb$/, `sent.${e}`)))
        .filter(f => name.endsWith('.answer.glb') && existsSync(f));
    const before = new Set((await Promise.all(sent.map(errors))).flat());
    const added = (await errors(join(folder, name))).filter(e => !before.has(e));
    if (added.length > 0) {
        console.log(`${name}: ${added.length} errors`);
        for (const error of added.slice(0, 5)) { console.log(`    ${error}`); }
        ++failed;
    }
    ++files;
}
console.log(`${files} files validated, ${failed} with errors of ours`);
process.exit(failed > 0 || files === 0 ? 1 : 0);
