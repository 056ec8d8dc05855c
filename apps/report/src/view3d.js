// The bodies of a run in their box: instanced meshes, coloured by orientation, frame by frame.
import {
  AmbientLight, Box3Helper, Box3, Color, DirectionalLight, DoubleSide, HemisphereLight, InstancedMesh, Matrix4,
  MeshStandardMaterial, PerspectiveCamera, Plane, Quaternion, Scene, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { floats, integers } from './bytes.js';
import { cssRgb, directionBall, directionColour, linearToSrgb, rampColour, rampGradient, srgbToLinear } from './colours.js';
import { cssColour, download, fileName, h, tool } from './dom.js';
import { grouped, short } from './format.js';
import { nematicOrder } from './nematic.js';
import { polytopeGeometry, superellipsoidGeometry } from './shapes.js';
import { onThemeChange } from './theme.js';

const kLegendSize = 84;

/** Divisions of a cube face: fewer, the more bodies there are. */
function divisionsFor(bodies) {
  if (bodies <= 150) return 18;
  if (bodies <= 600) return 14;
  if (bodies <= 2500) return 9;
  if (bodies <= 6000) return 6;
  return 4;
}

function isSphere(shape) {
  const [a, b, c] = shape.semi_axes;
  return shape.polytope === undefined && a === b && b === c && shape.exponents.every((e) => e === 1);
}

/** Insides of bodies that are cut open are drawn in one flat, darker tone: the cut looks solid. */
function bodyMaterial() {
  const material = new MeshStandardMaterial({ roughness: 0.52, metalness: 0, side: DoubleSide });
  material.onBeforeCompile = (shader) => {
    shader.fragmentShader = shader.fragmentShader.replace('#include <opaque_fragment>',
      'if (!gl_FrontFacing) outgoingLight = diffuseColor.rgb * 0.55;\n#include <opaque_fragment>');
  };
  return material;
}

export class View3d {
  constructor(run) {
    this.run = run;
    this.data = run.view;
    this.shapeOf = integers(this.data.shape_of);
    this.speciesOf = integers(this.data.species_of);
    this.bodies = this.shapeOf.length;
    this.frame = this.data.frames.length - 1;
    this.decoded = new Map();
    this.mode = this.modes()[0].key;
    this.clip = { axis: 2, share: 1 };
    this.element = this.layout();
    // What a browser without WebGL shows instead of the picture.
    try {
      this.start();
    } catch (error) {
      this.stage.replaceChildren(h('p', { class: 'none' }, `No 3-D view: this browser gave no WebGL (${error.message}).`));
    }
  }

  modes() {
    const list = [{ key: 'direction', label: 'direction of the axis' }, { key: 'angle', label: 'angle to the director' }];
    if (this.run.species.length > 1) list.push({ key: 'species', label: 'species' });
    list.push({ key: 'plain', label: 'one colour' });
    return this.data.shapes.every(isSphere) ? list.filter((m) => m.key === 'species' || m.key === 'plain') : list;
  }

  // ---- Elements ------------------------------------------------------------------------------------------------------

  layout() {
    this.canvas = h('canvas', {
      tabindex: 0, role: 'img',
      'aria-label': `${grouped(this.bodies)} bodies in their box. Arrow keys turn the view, plus and minus zoom, R resets, space plays.`,
    });
    this.stage = h('div', { class: 'stage' }, this.canvas);
    this.caption = h('p', { class: 'caption', 'aria-live': 'polite' });
    this.legend = h('div', { class: 'colour-legend' });
    this.stage.append(this.legend);
    const colour = h('select', { onchange: () => { this.mode = colour.value; this.paint(); this.showLegend(); } },
      this.modes().map((m) => h('option', { value: m.key }, m.label)));
    const header = h('header', {}, h('div', {}, h('h3', {}, 'The bodies'), this.caption),
      h('div', { class: 'tools' },
        tool('Reset the view', 'reset', () => this.reset()), tool('Save the view as PNG', 'PNG', () => this.savePicture())));
    return h('article', { class: 'card view', 'aria-label': 'Three-dimensional view' }, header, this.stage,
      h('div', { class: 'controls' }, this.player(), h('label', {}, h('span', {}, 'Colour'), colour), this.clipper()));
  }

  player() {
    const last = this.data.frames.length - 1;
    if (last < 1) return null;
    this.play = tool('Play the stored frames', '▶', () => this.togglePlay(), { class: 'tool play' });
    this.slider = h('input', { type: 'range', min: 0, max: last, value: last, 'aria-label': 'Stored frame',
      oninput: () => { this.stop(); this.show(Number(this.slider.value)); } });
    return h('div', { class: 'player' }, this.play, this.slider);
  }

  clipper() {
    const axis = h('select', { 'aria-label': 'Axis of the cut', onchange: () => { this.clip.axis = axis.selectedIndex; this.cut(); } },
      ['x', 'y', 'z'].map((name, k) => h('option', { selected: k === this.clip.axis }, name)));
    this.clipSlider = h('input', { type: 'range', min: 0, max: 100, value: 100, 'aria-label': 'Where the box is cut',
      oninput: () => { this.clip.share = Number(this.clipSlider.value) / 100; this.cut(); } });
    return h('div', { class: 'clip' }, h('span', {}, 'Cut'), axis, this.clipSlider);
  }

  // ---- Scene ---------------------------------------------------------------------------------------------------------

  start() {
    const { box } = this.data;
    this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true, preserveDrawingBuffer: false });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.localClippingEnabled = true;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(32, 1, 0.05 * box, 20 * box);
    this.camera.up.set(0, 0, 1);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 0.55), new HemisphereLight(0xffffff, 0x8a8378, 1.05));
    this.lamp = new DirectionalLight(0xffffff, 2.1);
    this.camera.add(this.lamp);
    this.lamp.position.set(-0.7, 1, 1.2);
    this.camera.add(this.lamp.target);
    this.lamp.target.position.set(0, 0, -1);
    this.plane = new Plane(new Vector3(0, 0, -1), Infinity);
    this.edges = new Box3Helper(new Box3(new Vector3(-box, -box, -box).multiplyScalar(0.5), new Vector3(box, box, box).multiplyScalar(0.5)));
    this.scene.add(this.edges);
    this.makeMeshes();
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = false;
    this.controls.enablePan = false;
    this.controls.minDistance = 0.6 * box;
    this.controls.maxDistance = 8 * box;
    this.controls.addEventListener('change', () => this.draw());
    this.canvas.addEventListener('keydown', (event) => this.key(event));
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(this.stage);
    // Nobody waits for what is not seen.
    this.sights = new IntersectionObserver(([entry]) => {
      this.seen = entry.isIntersecting;
      if (this.seen && this.stale) this.draw();
    });
    this.sights.observe(this.stage);
    this.forgetTheme = onThemeChange(() => this.retheme());
    this.reset();
    this.retheme();
    this.show(this.frame);
  }

  /** Makes one mesh for all shapes that differ in their semi-axes or size only. */
  makeMeshes() {
    const kinds = new Map();
    for (let i = 0; i < this.bodies; i += 1) {
      const { polytope, exponents } = this.data.shapes[this.shapeOf[i]];
      const key = polytope === undefined ? exponents.join(',') : `polytope ${polytope}`;
      if (!kinds.has(key)) kinds.set(key, []);
      kinds.get(key).push(i);
    }
    const divisions = divisionsFor(this.bodies);
    this.material = bodyMaterial();
    this.meshes = [...kinds.values()].map((members) => {
      const { polytope, exponents } = this.data.shapes[this.shapeOf[members[0]]];
      const geometry = polytope === undefined
        ? superellipsoid(exponents, divisions) : polytopeGeometry(this.data.polytopes[polytope], divisions);
      const mesh = new InstancedMesh(geometry, this.material, members.length);
      mesh.frustumCulled = false;
      this.scene.add(mesh);
      return { mesh, members };
    });
  }

  frameData(index) {
    if (!this.decoded.has(index)) {
      const frame = this.data.frames[index];
      const positions = floats(frame.positions);
      const orientations = floats(frame.orientations);
      const axes = new Float32Array(positions.length);
      for (let i = 0; i < this.bodies; i += 1) {
        const [w, x, y, z] = orientations.subarray(4 * i, 4 * i + 4);
        axes.set([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], 3 * i);
      }
      this.decoded.set(index, { time: frame.time, positions, orientations, axes, order: nematicOrder(axes) });
    }
    return this.decoded.get(index);
  }

  show(index) {
    this.frame = index;
    const { positions, orientations } = this.frameData(index);
    const matrix = new Matrix4();
    const place = new Vector3();
    const turn = new Quaternion();
    const size = new Vector3();
    for (const { mesh, members } of this.meshes) {
      members.forEach((i, k) => {
        place.fromArray(positions, 3 * i);
        turn.set(orientations[4 * i + 1], orientations[4 * i + 2], orientations[4 * i + 3], orientations[4 * i]);
        size.fromArray(this.data.shapes[this.shapeOf[i]].semi_axes);
        mesh.setMatrixAt(k, matrix.compose(place, turn, size));
      });
      mesh.instanceMatrix.needsUpdate = true;
    }
    if (this.slider) this.slider.value = index;
    this.describe();
    this.paint();
  }

  describe() {
    const { time, order } = this.frameData(this.frame);
    const frames = this.data.frames.length;
    const parts = [`${grouped(this.bodies)} bodies`, `t = ${short(time, 4)}`];
    if (frames > 1) parts.push(`frame ${this.frame + 1} of ${frames}`);
    if (!this.data.shapes.every(isSphere)) parts.push(`S = ${order.S.toFixed(3)} in this frame`);
    this.caption.textContent = `${parts.join(' · ')}${this.data.note ? ` · ${this.data.note.trim()}` : ''}`;
  }

  colourOf(i, { axes, order }, palette) {
    const [x, y, z] = [axes[3 * i], axes[3 * i + 1], axes[3 * i + 2]];
    if (this.mode === 'direction') return directionColour(x, y, z);
    if (this.mode === 'angle') {
      const [a, b, c] = order.director;
      return srgbToLinear(rampColour(1 - Math.acos(Math.min(1, Math.abs(a * x + b * y + c * z))) / (Math.PI / 2)));
    }
    return palette[this.mode === 'species' ? this.speciesOf[i] % palette.length : 0];
  }

  paint() {
    if (!this.meshes) return;
    const frame = this.frameData(this.frame);
    const colour = new Color();
    for (const { mesh, members } of this.meshes) {
      members.forEach((i, k) => mesh.setColorAt(k, colour.setRGB(...this.colourOf(i, frame, this.palette))));
      mesh.instanceColor.needsUpdate = true;
    }
    this.draw();
  }

  cut() {
    const { axis, share } = this.clip;
    const normal = new Vector3().setComponent(axis, -1);
    const reach = Math.max(...this.data.shapes.flatMap((s) => s.semi_axes));
    const half = 0.5 * this.data.box + reach;
    this.plane.set(normal, share >= 1 ? Infinity : -half + 2 * half * share);
    const on = share < 1;
    if (on !== Boolean(this.material.clippingPlanes?.length)) {
      this.material.clippingPlanes = on ? [this.plane] : [];
      this.material.needsUpdate = true;
    }
    this.draw();
  }

  // ---- Legend --------------------------------------------------------------------------------------------------------

  showLegend() {
    const { mode } = this;
    if (mode === 'direction') {
      this.ball = h('canvas', { width: 2 * kLegendSize, height: 2 * kLegendSize, role: 'img',
        'aria-label': 'Colours of directions: red along x, green along y, blue along z' });
      this.ballTurn = null;
      this.legend.replaceChildren(this.ball, h('p', {}, h('b', { class: 'x' }, 'x'), h('b', { class: 'y' }, 'y'), h('b', { class: 'z' }, 'z')));
      ['x', 'y', 'z'].forEach((name, k) => {
        this.legend.querySelector(`.${name}`).style.color = cssRgb(linearToSrgb(directionColour(...[0, 1, 2].map((j) => Number(j === k)))));
      });
      return;
    }
    this.ball = null;
    if (mode === 'angle') {
      const bar = h('div', { class: 'bar' });
      bar.style.background = rampGradient;
      this.legend.replaceChildren(bar, h('p', { class: 'ends' }, h('span', {}, '90°'), h('span', {}, '0°')));
    } else if (mode === 'species') {
      this.legend.replaceChildren(h('ul', {}, this.run.species.map((s, k) => h('li', { class: `c${k % 8}` }, s.title))));
    } else {
      this.legend.replaceChildren();
    }
  }

  /** The ball turns with the box: a body that points where a spot of the ball does has its colour. Nothing is done
      while the camera does not turn, as when frames are played. */
  drawBall() {
    if (!this.ball || this.ballTurn?.equals(this.camera.quaternion)) return;
    this.ballTurn = this.camera.quaternion.clone();
    const context = this.ball.getContext('2d');
    const image = context.createImageData(this.ball.width, this.ball.height);
    directionBall(image, new Matrix4().makeRotationFromQuaternion(this.ballTurn).elements);
    context.putImageData(image, 0, 0);
    this.balls = (this.balls ?? 0) + 1;
  }

  // ---- Drawing -------------------------------------------------------------------------------------------------------

  /** Draws at the next frame of the browser, once. */
  draw() {
    if (this.waiting || !this.renderer) return;
    this.stale = !this.seen;
    if (this.stale) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
      this.drawBall();
      this.drawn = (this.drawn ?? 0) + 1;
    });
  }

  reset() {
    if (!this.renderer) return;
    const distance = 3.05 * this.data.box;
    this.camera.position.set(0.62, -0.68, 0.4).normalize().multiplyScalar(distance);
    this.controls.target.set(0, 0, 0);
    this.controls.update();
    this.draw();
  }

  resize() {
    const width = this.stage.clientWidth;
    const height = this.stage.clientHeight;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // On a narrow stage the box still fits.
    this.camera.fov = width < height ? 2 * Math.atan(Math.tan(Math.PI * 16 / 180) * height / width) * 180 / Math.PI : 32;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  retheme() {
    this.scene.background = new Color(cssColour('--stage'));
    this.edges.material.color.set(cssColour('--muted'));
    this.palette = Array.from({ length: 8 }, (_, k) => new Color(cssColour(`--c${k}`)).toArray());
    this.paint();
    this.showLegend();
  }

  // ---- Play, keys, files ---------------------------------------------------------------------------------------------

  togglePlay() {
    if (this.timer) this.stop();
    else this.playOn();
  }

  playOn() {
    this.play.textContent = '❚❚';
    this.play.setAttribute('aria-label', 'Pause');
    const pause = Math.max(60, Math.min(250, 12000 / this.data.frames.length));
    this.timer = setInterval(() => this.show((this.frame + 1) % this.data.frames.length), pause);
  }

  stop() {
    clearInterval(this.timer);
    this.timer = null;
    if (!this.play) return;
    this.play.textContent = '▶';
    this.play.setAttribute('aria-label', 'Play the stored frames');
  }

  key(event) {
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (turns[event.key]) this.turn(...turns[event.key]);
    else if (event.key === '+' || event.key === '=') this.zoom(0.9);
    else if (event.key === '-') this.zoom(1 / 0.9);
    else if (event.key === 'r' || event.key === 'R') this.reset();
    else if (event.key === ' ' && this.play) this.togglePlay();
    else return;
    event.preventDefault();
  }

  turn(horizontal, vertical) {
    const { position } = this.camera;
    const radius = position.length();
    const azimuth = Math.atan2(position.y, position.x) + horizontal * 0.1;
    const height = Math.min(1.5, Math.max(-1.5, Math.asin(position.z / radius) - vertical * 0.1));
    position.set(Math.cos(height) * Math.cos(azimuth), Math.cos(height) * Math.sin(azimuth), Math.sin(height)).multiplyScalar(radius);
    this.controls.update();
  }

  zoom(factor) {
    this.camera.position.multiplyScalar(factor);
    this.controls.update();
    this.draw();
  }

  savePicture() {
    if (!this.renderer) return;
    this.renderer.render(this.scene, this.camera);
    this.canvas.toBlob((blob) => download(`${fileName(this.run.name)}-bodies.png`, blob));
  }

  /** Gives back what a page has few of: browsers allow some sixteen WebGL contexts. */
  dispose() {
    this.stop();
    if (!this.renderer) return;
    this.forgetTheme();
    this.sizes.disconnect();
    this.sights.disconnect();
    this.controls.dispose();
    for (const { mesh } of this.meshes) {
      mesh.geometry.dispose();
      mesh.dispose();
    }
    this.material.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.renderer = null;
    this.meshes = null;
  }
}

function superellipsoid(exponents, divisions) {
  return superellipsoidGeometry(exponents, exponents.every((e) => e === 1) ? divisions : Math.ceil(1.25 * divisions));
}
