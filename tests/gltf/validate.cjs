// Runs the Khronos glTF validator: node validate.cjs VALIDATOR_FOLDER MODEL…
// Prints one JSON object: for each model, how often each "SEVERITY CODE" was reported (severity 0 error … 3 hint).
const fs = require('fs');
const path = require('path');
const validator = require(path.resolve(process.argv[2]));

async function validate(file) {
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  const counts = {};
  for (const { severity, code } of report.issues.messages) {
    const key = `${severity} ${code}`;
    counts[key] = (counts[key] || 0) + 1;
  }
  return counts;
}

(async () => {
  const result = {};
  for (const file of process.argv.slice(3)) result[file] = await validate(file);
  console.log(JSON.stringify(result));
})();
