// The validator has neither errors nor warnings, notes at most that no picture uses the texture coordinates, and finds
// so many morph targets.
const [path, targets] = process.argv.slice(1);
const validator = require('gltf-validator');
const fail = (text) => { console.error(text); process.exit(1); };
validator.validateBytes(new Uint8Array(require('fs').readFileSync(path))).then((report) => {
  const isUnusedPicture = ({ code, pointer }) => code === 'UNUSED_OBJECT' && pointer.endsWith('/TEXCOORD_0');
  const messages = report.issues.messages.filter((message) => !isUnusedPicture(message));
  if (messages.length > 0) fail(JSON.stringify(messages.slice(0, 5)));
  if (report.info.hasMorphTargets !== targets > 0) fail(JSON.stringify(report.info));
  if (report.info.animationCount !== (targets > 0 ? 1 : 0)) fail(JSON.stringify(report.info));
}, (error) => fail(String(error)));
