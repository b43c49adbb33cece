// Pictures by three.js in a headless Chromium: node three_view.mjs NODE_MODULES CHROMIUM VIEWS.json
// VIEWS.json is a list of {"model": GLB, "camera": as `applique render --camera` writes it, "output": PNG}; the
// background is transparent.
import fs from 'fs';
import http from 'http';
import os from 'os';
import path from 'path';
import { pathToFileURL } from 'url';

const modules = path.resolve(process.argv[2]);
const views = JSON.parse(fs.readFileSync(process.argv[4]));
const puppeteer = await import(pathToFileURL(path.join(modules, 'puppeteer-core/lib/puppeteer/puppeteer-core.js')));

const page = `<!doctype html><script type="importmap">
{"imports": {"three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"}}</script>
<script type="module">
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

window.draw = async (model, { eye, target, up, vertical_fov_degrees, size }) => {
  const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setSize(size[0], size[1], false);
  const scene = new THREE.Scene();
  scene.add((await new GLTFLoader().loadAsync(model)).scene);
  const at = new THREE.Vector3(...eye), distance = at.distanceTo(new THREE.Vector3(...target));
  const camera = new THREE.PerspectiveCamera(vertical_fov_degrees, size[0] / size[1], distance / 100, distance * 100);
  camera.position.copy(at);
  camera.up.set(...up);
  camera.lookAt(...target);
  scene.add(new THREE.AmbientLight(0xffffff, 1.4));
  const key = new THREE.DirectionalLight(0xffffff, 1.8);
  camera.updateMatrixWorld();
  key.position.set(-0.5, 0.7, 1).transformDirection(camera.matrixWorld).multiplyScalar(distance).add(key.target.position.set(...target));
  scene.add(key, key.target);
  renderer.render(scene, camera);
  const picture = renderer.domElement.toDataURL('image/png');
  renderer.dispose();
  renderer.forceContextLoss();
  return picture;
};
window.ready = true;
</script>`;

const server = http.createServer((request, response) => {
  const url = new URL(request.url, 'http://localhost');
  const send = (type, bytes) => response.writeHead(200, { 'Content-Type': type }).end(bytes);
  if (url.pathname === '/') return send('text/html', page);
  if (url.pathname === '/model') return send('model/gltf-binary', fs.readFileSync(views[url.searchParams.get('view')].model));
  if (url.pathname === '/favicon.ico') return response.writeHead(204).end();
  const file = path.join(modules, url.pathname);
  if (!url.pathname.startsWith('/three/') || !fs.existsSync(file)) return response.writeHead(404).end();
  return send('text/javascript', fs.readFileSync(file));
});
await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));

const profile = fs.mkdtempSync(path.join(os.tmpdir(), 'applique-chromium-'));
const browser = await puppeteer.launch({
  executablePath: process.argv[3],
  userDataDir: profile,
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
});
try {
  const tab = await browser.newPage();
  tab.on('pageerror', (error) => console.error(String(error)));
  tab.on('console', (message) => { if (message.type() === 'error') console.error(message.text()); });
  await tab.goto(`http://127.0.0.1:${server.address().port}/`);
  await tab.waitForFunction('window.ready === true');
  for (const [i, { camera, output }] of views.entries()) {
    const picture = await tab.evaluate((model, view) => window.draw(model, view), `/model?view=${i}`, camera);
    fs.writeFileSync(output, Buffer.from(picture.split(',')[1], 'base64'));
  }
} finally {
  await browser.close();
  server.close();
  fs.rmSync(profile, { recursive: true, force: true });
}
