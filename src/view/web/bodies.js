// The bodies of a run as one mesh: every corner knows its line, and a texture holds pose and colour of every line.
import * as THREE from 'three';
import { CHOICES, heat } from './colours.js';

const WIDTH = 1024, TEXELS = 3; // of the texture; per line: position and life, orientation, colour and carrier

const DECLARE = `
attribute vec3 place;        // line, line behind the face (-1: none), value of the face
uniform sampler2D poses;
uniform float byFace;
varying vec3 tint;
vec4 poseTexel(float line, int k) { int i = int(line + 0.5) * ${TEXELS} + k; return texelFetch(poses, ivec2(i % ${WIDTH}, i / ${WIDTH}), 0); }
`;
const MOVE = `
vec4 own = poseTexel(place.x, 0), turn = poseTexel(place.x, 1), paint = poseTexel(place.x, 2);
transformed += 2.0 * cross(turn.xyz, cross(turn.xyz, transformed) + turn.w * transformed);
transformed += own.xyz;
// What is not there is no triangle, nor is a face between two tets of one piece, but for its cracks while it is deformed.
bool inside = place.y >= 0.0 && (place.z <= 0.0 || own.w < 1.5) && abs(poseTexel(place.y, 2).w - paint.w) < 0.5;
if (own.w < 0.5 || inside) transformed = vec3(0.0);
`;

// Walls that are opened let the eye in: they are without what is turned away from the middle of the pieces.
function open(material, uniforms) {
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.fragmentShader = shader.fragmentShader.replace('#include <common>', '#include <common>\nuniform float opened; uniform vec3 middle;')
      .replace('#include <normal_fragment_begin>', `#include <normal_fragment_begin>
        if (opened > 0.5 && dot(normal, (viewMatrix * vec4(middle, 1.0)).xyz + vViewPosition) < 0.0) discard;`);
  };
  return material;
}

function move(material, uniforms, fragment) {
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = shader.vertexShader.replace('#include <common>', '#include <common>\n' + DECLARE)
      .replace('#include <begin_vertex>', '#include <begin_vertex>\n' + MOVE + 'tint = paint.rgb;');
    if (!fragment) return;
    shader.vertexShader = shader.vertexShader.replace('tint = paint.rgb;', 'tint = mix(paint.rgb, heat, byFace);')
      .replace('varying vec3 tint;', 'varying vec3 tint;\nattribute vec3 heat;');
    shader.fragmentShader = shader.fragmentShader.replace('#include <common>', '#include <common>\nvarying vec3 tint;')
      .replace('#include <color_fragment>', 'diffuseColor.rgb = tint;');
  };
  return material;
}

// Pairs of vertices where two faces of a convex piece meet at an angle.
function sharpEdges({ vertices, faces }) {
  const corner = (v) => new THREE.Vector3().fromArray(vertices, 3 * v), seen = new Map(), edges = [];
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => corner(faces[f + k])), normal = b.sub(a).cross(c.sub(a)).normalize();
    for (let k = 0; k < 3; k++) {
      const one = faces[f + k], two = faces[f + (k + 1) % 3], key = Math.min(one, two) * 256 + Math.max(one, two), other = seen.get(key);
      if (other === undefined) seen.set(key, normal);
      else if (other.dot(normal) < 0.999) edges.push([one, two]);
    }
  }
  return edges;
}

export class Bodies {
  constructor(run) {
    this.run = run;
    this.scene = new THREE.Scene();
    const count = Math.ceil(Math.max(1, run.count) * TEXELS / WIDTH);
    this.poses = new Float32Array(WIDTH * count * 4);
    this.texture = new THREE.DataTexture(this.poses, WIDTH, count, THREE.RGBAFormat, THREE.FloatType);
    this.uniforms = { poses: { value: this.texture }, byFace: { value: 0 } };
    this.opening = { opened: { value: 0 }, middle: { value: new THREE.Vector3() } };
    this.addPieces();
    this.addHulls();
    this.addObstacles();
    this.addLights();
    this.scratch = new Float64Array(7);
  }

  addPieces() {
    const { run } = this, geometry = new THREE.BufferGeometry();
    this.corner = run.shapes ? Float32Array.from(run.corner) : run.corner;
    this.place = new Float32Array(run.faces * 9);
    this.heat = new Uint8Array(run.faces * 9);
    for (let line = 0; line < run.count; line++)
      for (let f = run.begin[line]; f < run.begin[line + 1]; f++)
        for (let k = 0; k < 3; k++) this.place.set([line, run.other[f], 0], 9 * f + 3 * k);
    const attribute = (name, array, normalised) => {
      const made = new THREE.BufferAttribute(array, 3, normalised);
      if (run.shapes) made.setUsage(THREE.DynamicDrawUsage);
      geometry.setAttribute(name, made);
    };
    attribute('position', this.corner);
    attribute('place', this.place);
    attribute('heat', this.heat, true);
    // Cracked runs show the inner sides of cracks, whose tets may be inside out.
    const side = run.shapes ? THREE.DoubleSide : THREE.FrontSide;
    this.mesh = new THREE.Mesh(geometry, move(new THREE.MeshLambertMaterial({ flatShading: true, side }), this.uniforms, true));
    this.mesh.customDepthMaterial = move(new THREE.MeshDepthMaterial({ depthPacking: THREE.RGBADepthPacking, side }), this.uniforms, false);
    this.mesh.frustumCulled = false;
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.scene.add(this.mesh);
    this.pickMaterial = new THREE.ShaderMaterial({
      uniforms: this.uniforms, side,
      vertexShader: DECLARE + `flat varying float who; void main() { vec3 transformed = position; ${MOVE} tint = vec3(0.0); who = place.x + 1.0; gl_Position = projectionMatrix * viewMatrix * vec4(transformed, 1.0); }`,
      fragmentShader: 'flat varying float who; void main() { gl_FragColor = vec4(mod(who, 256.0), mod(floor(who / 256.0), 256.0), floor(who / 65536.0), 255.0) / 255.0; }',
    });
  }

  // Edges of the convex pieces, drawn over bodies that let them through; each is there while its own fragment is.
  addHulls() {
    const { run } = this, ends = [], owners = [];
    for (const { fragment, pieces } of run.hulls) {
      const own = run.fragment[fragment], line = run.leaf.findIndex((leaf) => run.fragment[leaf].line === own.line), last = run.fragment[run.leaf[line]];
      for (const piece of pieces)
        for (const [a, b] of sharpEdges(piece))
          for (const v of [a, b]) {
            ends.push(piece.vertices[3 * v] + own.x - last.x, piece.vertices[3 * v + 1] + own.y - last.y, piece.vertices[3 * v + 2] + own.z - last.z);
            owners.push(line, fragment);
          }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(ends, 3));
    geometry.setAttribute('owner', new THREE.Float32BufferAttribute(owners, 2));
    this.hulls = new THREE.LineSegments(geometry, new THREE.ShaderMaterial({
      uniforms: { ...this.uniforms, ink: { value: new THREE.Color() } },
      vertexShader: DECLARE.replace('attribute vec3 place;', 'attribute vec2 owner;') + `void main() {
        vec4 own = poseTexel(owner.x, 0), turn = poseTexel(owner.x, 1);
        vec3 at = position + 2.0 * cross(turn.xyz, cross(turn.xyz, position) + turn.w * position) + own.xyz;
        bool there = own.w > 0.5 && abs(poseTexel(owner.x, 2).w - owner.y) < 0.5;
        gl_Position = there ? projectionMatrix * viewMatrix * vec4(at, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
      }`,
      fragmentShader: 'uniform vec3 ink; void main() { gl_FragColor = vec4(ink, 1.0); }',
    }));
    this.hulls.frustumCulled = false;
    this.hulls.visible = false;
    this.scene.add(this.hulls);
  }

  showHulls(on) {
    this.hulls.visible = on;
    Object.assign(this.mesh.material, { transparent: on, opacity: on ? 0.4 : 1, depthWrite: !on, needsUpdate: true });
  }

  addObstacles() {
    this.obstacles = this.run.obstacles.map((obstacle) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(obstacle.positions, 3));
      geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(obstacle.triangles), 1));
      const round = obstacle.shape === 'sphere';
      if (round) geometry.computeVertexNormals();
      const plane = obstacle.shape === 'plane', wall = !plane && obstacle.motion !== 'free';
      const material = new THREE.MeshLambertMaterial({ flatShading: !round });
      const mesh = new THREE.Mesh(geometry, wall ? open(material, this.opening) : material);
      mesh.receiveShadow = true;
      mesh.castShadow = !plane;
      mesh.userData = { plane, wall };
      this.scene.add(mesh);
      return mesh;
    });
  }

  get walls() { return this.obstacles.filter((mesh) => mesh.userData.wall); }

  // Whether one wall is round all pieces as the run begins.
  get enclosed() {
    const { run } = this, at = { frame: 0, next: 0, share: 0 }, lines = Array.from({ length: run.count }, (_, line) => line).filter((line) => run.carrierAt(0, line) >= 0);
    this.obstacles.forEach((mesh, i) => this.showObstacle(mesh, i, at));
    return this.walls.some((mesh) => {
      const box = new THREE.Box3().setFromObject(mesh);
      return lines.every((line) => box.containsPoint(new THREE.Vector3(...run.pose(at, line, this.scratch).slice(0, 3))));
    });
  }

  showOpen(on) {
    this.opening.opened.value = on ? 1 : 0;
    this.walls.forEach((mesh) => { mesh.castShadow = !on; });
  }

  addLights() {
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0xb9b2a6, 1.5));
    this.lamp = new THREE.DirectionalLight(0xffffff, 2.1);
    this.lamp.castShadow = true;
    this.lamp.shadow.mapSize.set(2048, 2048);
    this.lamp.shadow.radius = 3;
    this.scene.add(this.lamp, this.lamp.target);
  }

  // Lamp, haze and grid around what is looked at.
  surround(centre, reach) {
    this.reach = reach;
    this.opening.middle.value.set(...centre);
    this.lamp.position.set(centre[0] - 0.9 * reach, centre[1] - 1.35 * reach, centre[2] + 3 * reach);
    this.lamp.target.position.set(...centre);
    Object.assign(this.lamp.shadow.camera, { left: -2 * reach, right: 2 * reach, top: 2 * reach, bottom: -2 * reach, near: 0.1 * reach, far: 8 * reach });
    this.lamp.shadow.camera.updateProjectionMatrix();
    this.lamp.shadow.bias = -0.0022;
    this.scene.fog ??= new THREE.Fog(0);
    Object.assign(this.scene.fog, { near: 7 * reach, far: 16 * reach });
    this.planes = this.obstacles.filter((mesh) => mesh.userData.plane);
    this.planes.forEach((mesh) => this.widen(mesh, centre, reach));
  }

  // A plane reaches into the haze, and has lines at round coordinates.
  widen(mesh, centre, reach) {
    const attribute = mesh.geometry.getAttribute('position'), [a, b, c] = [0, 1, 2].map((i) => new THREE.Vector3().fromBufferAttribute(attribute, i));
    const one = b.clone().sub(a).normalize(), two = c.clone().sub(b).normalize(), normal = one.clone().cross(two);
    const foot = new THREE.Vector3(...centre);
    foot.addScaledVector(normal, -foot.clone().sub(a).dot(normal));
    [[-1, -1], [1, -1], [1, 1], [-1, 1]].forEach(([x, y], i) => {
      const corner = foot.clone().addScaledVector(one, 30 * x * reach).addScaledVector(two, 30 * y * reach);
      attribute.setXYZ(i, corner.x, corner.y, corner.z);
    });
    mesh.geometry.computeBoundingSphere();
    const power = 10 ** Math.floor(Math.log10(reach / 3)), spacing = power * ([5, 2, 1].find((m) => m * power <= reach / 3) ?? 1);
    const uniforms = (mesh.userData.uniforms ??= { one: {}, two: {}, stripe: { value: new THREE.Color() } });
    uniforms.one.value = one.divideScalar(spacing);
    uniforms.two.value = two.divideScalar(spacing);
    mesh.userData.stripe = uniforms.stripe;
    mesh.material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, uniforms);
      shader.vertexShader = shader.vertexShader.replace('#include <common>', '#include <common>\nuniform vec3 one, two; varying vec2 square;')
        .replace('#include <begin_vertex>', '#include <begin_vertex>\nsquare = vec2(dot(position, one), dot(position, two));');
      shader.fragmentShader = shader.fragmentShader.replace('#include <common>', '#include <common>\nuniform vec3 stripe; varying vec2 square;')
        .replace('#include <color_fragment>', `vec2 wide = fwidth(square), off = abs(fract(square - 0.5) - 0.5) / wide;
          float ink = (1.0 - min(1.0, min(off.x, off.y))) * clamp(1.0 - 3.0 * max(wide.x, wide.y), 0.0, 1.0);
          diffuseColor.rgb = mix(diffuseColor.rgb, stripe, ink);`);
    };
  }

  dress(theme) {
    this.scene.background = new THREE.Color(theme.back);
    this.scene.fog.color.set(theme.back);
    this.obstacles.forEach((mesh) => mesh.material.color.set(mesh.userData.plane ? theme.floor : theme.obstacle));
    this.planes.forEach((mesh) => mesh.userData.stripe.value.set(theme.grid));
    this.hulls.material.uniforms.ink.value.set(theme.ink);
  }

  // at: frame, next frame, share between them and time; choice of CHOICES with what it prepared.
  show(at, choice, state, picked) {
    const { run, poses } = this, colour = CHOICES[choice], best = colour.begin?.(run, at);
    for (let line = 0; line < run.count; line++) {
      const base = line * TEXELS * 4, carrier = run.carrierAt(at.frame, line);
      const pose = run.pose(at, line, this.scratch);
      for (let k = 0; k < 3; k++) poses[base + k] = pose[k];
      poses[base + 3] = carrier < 0 ? 0 : run.awakeAt(at.frame, line) ? 2 : 1;
      for (let k = 0; k < 4; k++) poses[base + 4 + k] = pose[3 + k];
      const paint = carrier < 0 ? [0, 0, 0] : colour.colour?.(state, run, at, carrier, line, best) ?? [0.6, 0.6, 0.6];
      const glow = carrier === picked ? 0.45 : 0;
      for (let k = 0; k < 3; k++) poses[base + 8 + k] = Math.pow(paint[k] + glow * (1 - paint[k]), 2.2);
      poses[base + 11] = carrier;
    }
    this.texture.needsUpdate = true;
    this.uniforms.byFace.value = colour.face === undefined ? 0 : 1;
    if (run.shapes) this.showShapes(at, colour);
    this.obstacles.forEach((mesh, i) => this.showObstacle(mesh, i, at));
  }

  showShapes(at, colour) {
    const { run } = this, geometry = this.mesh.geometry;
    run.deform(at, this.corner);
    geometry.getAttribute('position').needsUpdate = true;
    if (this.shown === at.frame && this.shownFace === colour.face) return;
    this.shown = at.frame;
    this.shownFace = colour.face;
    for (let f = 0; f < run.faces; f++) {
      const damage = run.faceByte(at.frame, f, 0);
      for (let k = 0; k < 3; k++) this.place[9 * f + 3 * k + 2] = damage;
      if (colour.face === undefined) continue;
      const hot = heat(run.faceByte(at.frame, f, colour.face) / 255);
      for (let k = 0; k < 9; k++) this.heat[9 * f + k] = 255 * Math.pow(hot[k % 3], 2.2);
    }
    geometry.getAttribute('place').needsUpdate = true;
    if (colour.face !== undefined) geometry.getAttribute('heat').needsUpdate = true;
  }

  showObstacle(mesh, i, at) {
    const { obstaclePose: p, obstacles } = this.run, one = 7 * (at.frame * obstacles.length + i), two = 7 * (at.next * obstacles.length + i);
    const q = (k) => new THREE.Quaternion(p[k + 3], p[k + 4], p[k + 5], p[k + 6]);
    mesh.position.set(...[0, 1, 2].map((k) => p[one + k] + at.share * (p[two + k] - p[one + k])));
    mesh.quaternion.copy(q(one).slerp(q(two), at.share));
  }

  // The line under a point of the picture (−1 … 1), −1: none.
  pick(renderer, camera, x, y, width, height) {
    const target = new THREE.WebGLRenderTarget(1, 1), view = camera.clone(), pixel = new Uint8Array(4);
    view.setViewOffset(width, height, Math.floor((x + 1) / 2 * width), Math.floor((1 - y) / 2 * height), 1, 1);
    const others = this.scene.children.filter((child) => child !== this.mesh && child.visible && !child.isLight);
    const { background, fog } = this.scene, material = this.mesh.material;
    others.forEach((child) => { child.visible = false; });
    Object.assign(this.scene, { background: null, fog: null });
    this.mesh.material = this.pickMaterial;
    const shadows = renderer.shadowMap.enabled;
    renderer.shadowMap.enabled = false;
    renderer.setRenderTarget(target);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(this.scene, view);
    renderer.readRenderTargetPixels(target, 0, 0, 1, 1, pixel);
    renderer.setRenderTarget(null);
    renderer.shadowMap.enabled = shadows;
    this.mesh.material = material;
    Object.assign(this.scene, { background, fog });
    others.forEach((child) => { child.visible = true; });
    target.dispose();
    return pixel[3] > 0 ? pixel[0] + 256 * pixel[1] + 65536 * pixel[2] - 1 : -1;
  }
}
