// How well overlays follow the surface they lie on, posed by three.js: node pose.mjs THREE_FOLDER MODEL…
// For each model (a GLB with overlays) prints one line of JSON: over the animations' poses, how far the overlays'
// vertices stray from their places above the surface, as shares of the model's diagonal at rest.
import fs from 'fs';
import path from 'path';
import { pathToFileURL } from 'url';

const three = path.resolve(process.argv[2]);
const THREE = await import(pathToFileURL(path.join(three, 'build/three.module.js')));
globalThis.self = globalThis;
const { GLTFLoader } = await import(pathToFileURL(path.join(three, 'examples/jsm/loaders/GLTFLoader.js')));

const POSES = 8; // of each animation

/// The GLB without materials and images, which need a browser.
function bare(bytes) {
  const length = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + length).toString());
  for (const key of ['materials', 'textures', 'images', 'samplers']) delete json[key];
  for (const mesh of json.meshes)
    for (const primitive of mesh.primitives) {
      delete primitive.material;
      if (primitive.extensions) delete primitive.extensions.KHR_materials_variants;
    }
  let text = Buffer.from(JSON.stringify(json));
  text = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
  const out = Buffer.concat([bytes.subarray(0, 20), text, bytes.subarray(20 + length)]);
  out.writeUInt32LE(out.length, 8);
  out.writeUInt32LE(text.length, 12);
  return out.buffer.slice(out.byteOffset, out.byteOffset + out.length);
}

/// The vertices of a mesh as its pose puts them into the scene.
function posed(mesh) {
  const count = mesh.geometry.attributes.position.count;
  const points = [];
  for (let i = 0; i < count; ++i) {
    const point = new THREE.Vector3();
    mesh.getVertexPosition(i, point);
    points.push(point.applyMatrix4(mesh.matrixWorld));
  }
  return points;
}

/// The corners of the triangles, by primitives' vertices; those of a mirroring node are turned over.
function triangles(mesh) {
  const { index, attributes } = mesh.geometry;
  const count = index ? index.count : attributes.position.count;
  const corner = (i) => (index ? index.getX(i) : i);
  const mirrored = mesh.matrixWorld.determinant() < 0;
  const list = [];
  for (let i = 0; i + 2 < count; i += 3)
    list.push(mirrored ? [corner(i), corner(i + 2), corner(i + 1)] : [corner(i), corner(i + 1), corner(i + 2)]);
  return list;
}

function isOverlay(object) {
  for (let at = object; at; at = at.parent) if (at.userData?.applique?.decal) return true;
  return false;
}

const scratch = { triangle: new THREE.Triangle(), point: new THREE.Vector3(), bary: new THREE.Vector3() };

/// The nearest place on the meshes: which triangle, where in it, and how high above it the point is.
function nearest(point, bases) {
  let best = { distance: Infinity };
  for (const base of bases)
    for (const corners of base.triangles) {
      scratch.triangle.set(...corners.map((c) => base.points[c]));
      scratch.triangle.closestPointToPoint(point, scratch.point);
      const distance = scratch.point.distanceTo(point);
      if (distance < best.distance && scratch.triangle.getBarycoord(scratch.point, scratch.bary))
        best = { distance, base, corners, bary: scratch.bary.clone() };
    }
  return best;
}

function place(anchor) {
  const point = new THREE.Vector3();
  anchor.corners.forEach((c, k) => point.addScaledVector(anchor.base.points[c], anchor.bary.getComponent(k)));
  return point;
}

function heightAbove(point, anchor) {
  scratch.triangle.set(...anchor.corners.map((c) => anchor.base.points[c]));
  const normal = scratch.triangle.getNormal(new THREE.Vector3());
  return point.clone().sub(place(anchor)).dot(normal);
}

async function measure(file) {
  const gltf = await new GLTFLoader().parseAsync(bare(fs.readFileSync(file)), '');
  const scene = gltf.scene;
  const bases = [], overlays = [];
  scene.updateMatrixWorld(true);
  scene.traverse((object) => {
    if (!object.isMesh) return;
    (isOverlay(object) ? overlays : bases).push({ mesh: object, triangles: triangles(object) });
  });
  const pose = () => {
    scene.updateMatrixWorld(true);
    for (const shown of [...bases, ...overlays]) shown.points = posed(shown.mesh);
  };
  pose();
  const box = new THREE.Box3();
  for (const base of bases) for (const corners of base.triangles) for (const c of corners) box.expandByPoint(base.points[c]);
  const diagonal = box.getSize(new THREE.Vector3()).length();
  for (const overlay of overlays) overlay.anchors = overlay.points.map((point) => nearest(point, bases));
  const result = {
    model: path.basename(file), overlays: overlays.length, vertices: 0, poses: 0,
    rest: 0, // largest distance from the surface at rest
    moved: 0, // farthest way of a vertex from where it is at rest
    strayed: 0, // farthest from its place on the surface, less the distance at rest
    sunk: 0, // share of the vertices that lie below the surface, of all in all poses
  };
  for (const overlay of overlays) {
    result.vertices += overlay.points.length;
    overlay.rest = overlay.points.map((point) => point.clone());
    for (const anchor of overlay.anchors) result.rest = Math.max(result.rest, anchor.distance / diagonal);
  }
  let sunk = 0;
  const strays = [];
  for (const clip of gltf.animations)
    for (let k = 0; k < POSES; ++k) {
      const mixer = new THREE.AnimationMixer(scene);
      mixer.clipAction(clip).play();
      mixer.setTime((clip.duration * (k + 0.5)) / POSES);
      pose();
      ++result.poses;
      for (const overlay of overlays)
        overlay.points.forEach((point, i) => {
          const anchor = overlay.anchors[i];
          const stray = Math.max(0, point.distanceTo(place(anchor)) - anchor.distance) / diagonal;
          strays.push(stray);
          result.strayed = Math.max(result.strayed, stray);
          result.moved = Math.max(result.moved, point.distanceTo(overlay.rest[i]) / diagonal);
          if (heightAbove(point, anchor) < 0) ++sunk;
        });
      mixer.stopAllAction();
    }
  strays.sort((a, b) => a - b);
  result.strayed99 = strays.length ? strays[Math.floor(0.99 * (strays.length - 1))] : 0;
  result.sunk = strays.length ? sunk / strays.length : 0;
  return result;
}

for (const file of process.argv.slice(3)) console.log(JSON.stringify(await measure(file)));
