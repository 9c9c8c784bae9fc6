// Validates every .glb of a folder with the Khronos glTF validator: `node validate_gltf.mjs FOLDER`.
// Prints its issues; exit code 1 on errors or warnings, or where there is no .glb.

import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import validator from "gltf-validator";

const SEVERITIES = ["error", "warning", "info", "hint"];

const folder = process.argv[2];
if (folder === undefined) {
  console.error("usage: node validate_gltf.mjs FOLDER");
  process.exit(2);
}
const files = readdirSync(folder).filter((name) => name.endsWith(".glb")).sort();
if (files.length === 0) {
  console.error(`no .glb in ${folder}`);
  process.exit(1);
}
let bad = 0;
for (const name of files) {
  const bytes = new Uint8Array(readFileSync(join(folder, name)));
  const { issues, info } = await validator.validateBytes(bytes, { uri: name, maxIssues: 0 });
  const counts = `${issues.numErrors} errors, ${issues.numWarnings} warnings, ${issues.numInfos} infos, ${issues.numHints} hints`;
  console.log(`${name}: ${counts}; ${info.animationCount} animations, ${info.drawCallCount} draw calls`);
  for (const message of issues.messages.slice(0, 20)) {
    console.log(`  ${SEVERITIES[message.severity]}: ${message.code} at ${message.pointer ?? message.offset}: ${message.message}`);
  }
  bad += issues.numErrors + issues.numWarnings;
}
process.exit(bad > 0 ? 1 : 0);
