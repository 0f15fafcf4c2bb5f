// The interactive part of a report: the scene in time, plots beside it, criteria and checks as links.
//
// Its data come with the page: a header in JSON and one block of numbers. Drawing is done by k3d and the three.js in it,
// whose classes are taken from objects that k3d makes. Everything else is here, in this order: data, time, scene,
// plots, lists, keys, start. Names from a case are only ever set as text, never as HTML.
"use strict";

const heavylift = (() => {
  const node = (id) => document.getElementById(`hl-${id}`);
  const make = (tag, attributes = {}, ...children) => {
    const made = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) {
      if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
      else if (key === "class") made.className = value;
      else made.setAttribute(key, value);
    }
    made.append(...children);
    return made;
  };
  const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
  const TYPES = { f4: Float32Array, f8: Float64Array, i2: Int16Array, u1: Uint8Array, i4: Int32Array };

  // ---- data: arrays by reference {o: offset, n: numbers, t: type, s: shape, low, step of quantised ones}

  let data = null; // header
  let bytes = null;

  function bytesOf(text) {
    const letters = atob(text), found = new Uint8Array(letters.length);
    for (let k = 0; k < found.length; k++) found[k] = letters.charCodeAt(k);
    return found;
  }

  async function inflated(packed) {
    const stream = new DecompressionStream("deflate"), writer = stream.writable.getWriter();
    writer.write(packed).catch(() => {}); // what is wrong is told by the other end
    writer.close().catch(() => {});
    return new Uint8Array(await new Response(stream.readable).arrayBuffer());
  }

  function raw(ref) {
    if (ref.t !== "f8") return new TYPES[ref.t](bytes.buffer, ref.o, ref.n);
    return new Float64Array(bytes.slice(ref.o, ref.o + 8 * ref.n).buffer); // the block is aligned to four bytes
  }

  function floats(ref) {
    const values = raw(ref);
    if (!ref.step) return ref.t === "f4" ? values : Float32Array.from(values);
    const found = new Float32Array(values.length), width = ref.step.length;
    for (let i = 0; i < found.length; i++) found[i] = ref.low[i % width] + ref.step[i % width] * values[i];
    return found;
  }

  const sizeOf = (ref) => ref.s.slice(1).reduce((product, count) => product * count, 1);

  // A quantity that changes with the keyframes of a timeline.
  class Keyed {
    constructor(ref, timeline) {
      this.size = sizeOf(ref);
      this.timeline = timeline;
      this.values = raw(ref);
      this.low = ref.low;
      this.step = ref.step;
      this.width = ref.step ? ref.step.length : 1;
    }

    read(time, out, offset = 0) { // linear between keyframes
      const { i, j, w } = this.timeline.at(time), { values, size, step, low, width } = this;
      const a = i * size, b = j * size;
      for (let k = 0; k < size; k++) {
        const value = values[a + k] + w * (values[b + k] - values[a + k]);
        out[offset + k] = step ? low[k % width] + step[k % width] * value : value;
      }
      return out;
    }
  }

  class Timeline {
    constructor(ref) {
      this.times = raw(ref);
      this.last = { time: NaN, i: 0, j: 0, w: 0 };
    }

    at(time) {
      if (this.last.time === time) return this.last;
      const { times } = this, end = times.length - 1;
      let low = 0, high = end;
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (times[middle] <= time) low = middle; else high = middle;
      }
      if (end >= 0 && time >= times[end]) low = high = end;
      const gap = times[high] - times[low];
      this.last = { time, i: low, j: high, w: gap > 0 ? clamp((time - times[low]) / gap, 0, 1) : 0 };
      return this.last;
    }

    nearest(time) {
      const { i, j, w } = this.at(time);
      return this.times[w < 0.5 ? i : j];
    }
  }

  let timelines = [];

  // ---- numbers as text

  function number(value, digits = 5) {
    if (value === null || value === undefined || Number.isNaN(value)) return "–";
    if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
    const size = Math.abs(value);
    if (size !== 0 && (size < 1e-3 || size >= 1e7)) return value.toExponential(digits - 1).replace(/\.?0+e/, "e");
    return String(Number(value.toPrecision(digits)));
  }

  function shortest(value) { // decimals of a number in single precision, without those that it never had
    for (let digits = 6; digits < 10; digits++) {
      const found = Number(value.toPrecision(digits));
      if (Math.fround(found) === value) return found;
    }
    return value;
  }

  const FACTORS = [["G", 1e9], ["M", 1e6], ["k", 1e3], ["", 1], ["m", 1e-3]];
  const SCALED = new Set(["N", "Pa", "N m", "J", "W", "N/m", "N s"]);

  function unitFor(unit, size) { // a unit that suits the size, and how many SI units it is
    if (unit === "rad") return ["deg", Math.PI / 180];
    if (!SCALED.has(unit) || !(size > 0) || !Number.isFinite(size)) return [unit === "1" ? "" : unit, 1];
    const [prefix, factor] = FACTORS.find(([, own]) => size >= own) || ["m", 1e-3];
    return [prefix + unit, factor];
  }

  // ---- time

  const clock = { now: 0, begin: 0, end: 0, playing: false, speed: 1, before: 0, pinned: false };

  function seek(time) {
    clock.now = clamp(Number(time), clock.begin, clock.end);
    dirty = plotsDirty = true;
  }

  function play(on = !clock.playing) {
    clock.playing = Boolean(on) && clock.end > clock.begin;
    if (clock.playing && clock.now >= clock.end) seek(clock.begin);
    clock.before = performance.now();
    const button = node("play");
    button.textContent = clock.playing ? "❚❚" : "▶";
    button.setAttribute("aria-label", clock.playing ? "pause" : "play");
    if (!clock.playing) sharpen();
  }

  function jump(time) {
    play(false);
    seek(time);
  }

  function nextRecord(way) {
    const { times } = timelines[0], { i } = timelines[0].at(clock.now);
    if (way > 0) jump(i + 1 < times.length ? times[i + 1] : clock.end);
    else jump(clock.now > times[i] || i === 0 ? times[i] : times[i - 1]);
  }

  const nextEvent = (way) => {
    const times = [...new Set(data.events.map((event) => event.time))].sort((a, b) => a - b);
    const slack = 1e-6 * (clock.end - clock.begin);
    const found = way > 0 ? times.find((time) => time > clock.now + slack)
      : times.reverse().find((time) => time < clock.now - slack);
    if (found !== undefined) jump(found);
  };

  // ---- scene

  let library = null, K3D = null, world = null, three = null;
  let root = null; // of all that is drawn of this data
  let dirty = true, plotsDirty = true;
  let scale = 1; // of deformation
  let level = 0; // of what is given up to be fast, see LEVELS
  let remembered = 0;
  let frames = []; // times of the last frames drawn [ms]
  const bodies = [];
  let items = []; // all that can be hidden
  let deformed = []; // surfaces whose points move
  const options = { follow: -1, labels: false, edges: true, section: "", measure: false };
  let picks = []; // of the measured distance
  let isolated = null;

  const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

  const isSoftware = (gl) => {
    const told = gl.getExtension("WEBGL_debug_renderer_info");
    return told !== null && /swiftshader|llvmpipe|software/i.test(gl.getParameter(told.UNMASKED_RENDERER_WEBGL));
  };

  async function openCanvas() {
    const target = node("canvas");
    const probe = document.createElement("canvas").getContext("webgl2");
    if (!probe) throw new Error("this browser draws no WebGL 2");
    const soft = isSoftware(probe); // four samples a pixel are too many for a processor
    const lost = probe.getExtension("WEBGL_lose_context");
    if (lost) lost.loseContext();
    // a grid that is not seen would be hundreds of labels, which are placed at every frame
    const { Initializers } = library.ThreeJsProvider;
    const provider = { ...library.ThreeJsProvider, Initializers: { ...Initializers, Scene(plot) {
      Initializers.Scene.call(this, plot);
      plot.rebuildSceneData = () => Promise.resolve();
    } } };
    K3D = new library.K3D(provider, target, {
      menuVisibility: false, gridVisible: false, gridAutoFit: false, cameraAutoFit: false, axesHelper: 0,
      antialias: soft ? 0 : 1, minimumFps: 0, cameraMode: "orbit", cameraUpAxis: data.up.axis,
      cameraDampingFactor: 0, renderOnChange: false, clearColor: 0xffffff, colorbarObjectId: -1,
      camera: [1, -1, 1, 0, 0, 0, ...data.up.vector],
    });
    world = K3D.getWorld();
    world.renderer.debug.checkShaderErrors = false; // asking for them waits for each program
    const triangle = { data: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]) };
    const common = {
      visible: true, color: 0, opacity: 1, attribute: [], color_map: [], color_range: [], colors: [],
      model_matrix: { data: IDENTITY }, vertices: triangle,
    };
    const seeds = await K3D.load({ objects: [
      { ...common, type: "Mesh", id: 1, indices: { data: new Uint32Array([0, 1, 2]) }, flat_shading: true,
        wireframe: false, side: "double", volume: [], volume_bounds: [], opacity_function: [], normals: [], uvs: [],
        triangles_attribute: [], texture: null },
      { ...common, type: "Lines", id: 2, indices: { data: new Uint32Array([0, 1]) }, indices_type: "segment",
        shader: "simple", width: 1, radial_segments: 8 },
    ] });
    const [mesh, line] = seeds.map((seed) => seed.obj);
    three = {
      Group: world.K3DObjects.constructor, Mesh: mesh.constructor, Geometry: mesh.geometry.constructor,
      Attribute: Object.getPrototypeOf(mesh.geometry.attributes.position.constructor).name === "BufferAttribute"
        ? Object.getPrototypeOf(mesh.geometry.attributes.position.constructor)
        : mesh.geometry.attributes.position.constructor,
      Segments: line.constructor, line: line.material.clone(),
      Vector: world.camera.position.constructor,
    };
    for (const seed of seeds) world.K3DObjects.remove(seed.obj);
    target.addEventListener("pointerdown", () => { dirty = true; });
    const canvas = world.renderer.domElement;
    let down = null;
    canvas.addEventListener("pointerdown", (event) => { down = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointerup", (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) clicked(event);
      down = null;
    });
    canvas.addEventListener("dblclick", (event) => {
      const hit = pick(event);
      if (hit) lookAt(hit.point.toArray());
    });
    K3D.on(K3D.events.CAMERA_CHANGE, () => { overlayDirty = true; });
    K3D.on(K3D.events.BEFORE_RENDER, depths);
    canvas.addEventListener("webglcontextlost", () => say("The drawing was lost by the browser; load the page again."));
  }

  // Flat faces under a lamp at the eye. On a processor this takes half the time of a physical material.
  function lit(shader) {
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nvarying vec3 vSeen;")
      .replace("#include <project_vertex>", "#include <project_vertex>\nvSeen = mvPosition.xyz;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nvarying vec3 vSeen;")
      .replace("#include <opaque_fragment>", `vec3 facing = normalize(cross(dFdx(vSeen), dFdy(vSeen)));
        outgoingLight *= 0.45 + 0.4 * abs(facing.z) + 0.15 * abs(facing.y);
        #include <opaque_fragment>`);
  }

  function surfaceMaterial(colour, opacity, coloured) {
    const material = three.line.clone();
    material.onBeforeCompile = lit;
    material.customProgramCacheKey = () => "lit";
    material.color.setHex(coloured ? 0xffffff : colour);
    material.vertexColors = coloured;
    material.side = 2;
    material.transparent = opacity < 1;
    material.opacity = opacity;
    material.depthWrite = opacity >= 0.9;
    material.depthTest = true;
    if (opacity >= 1) Object.assign(material, { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8 });
    return material;
  }

  function lineMaterial(colour) {
    const material = three.line.clone();
    material.vertexColors = false;
    material.color.setHex(colour);
    material.transparent = false;
    material.opacity = 1;
    return material;
  }

  function geometry(points, indices) {
    const made = new three.Geometry();
    made.setAttribute("position", new three.Attribute(points, 3));
    if (indices) made.setIndex(new three.Attribute(indices, 1));
    return made;
  }

  const rgb = (text) => parseInt(text.slice(1), 16);

  function build() {
    if (root) {
      world.scene.remove(root);
      root.traverse(({ geometry: shape, material }) => {
        if (shape) shape.dispose();
        if (material) material.dispose();
      });
    }
    root = new three.Group();
    world.scene.add(root);
    const before = new Map(items.map((item) => [`${item.group} ${item.name}`, item.hidden]));
    bodies.length = 0;
    items = [];
    deformed = [];
    for (const body of data.bodies) bodies.push(new Body(body));
    for (const surface of data.surfaces) items.push(new Surface(surface));
    for (const line of data.lines) items.push(new Line(line));
    for (const arrows of data.arrows) items.push(new Arrows(arrows));
    if (data.water) items.push(new Water(data.water));
    for (const item of items) item.hidden = before.get(`${item.group} ${item.name}`) ?? item.hidden;
    ruler = new Tube(root, 2, data.radius * 0.6, 0x111111);
    ruler.show(false);
  }

  class Body {
    constructor(spec) {
      this.name = spec.name;
      this.label = spec.name;
      this.group = new three.Group();
      this.group.matrixAutoUpdate = false;
      root.add(this.group);
      this.matrix = Float64Array.from(IDENTITY); // by columns, as WebGL has them
      this.there = true;
      this.centre = spec.centre;
      this.fixed = spec.fixed || null;
      if (spec.position) {
        this.position = new Keyed(spec.position, timelines[spec.timeline]);
        this.turned = floats(spec.orientation);
      }
      this.p = new Float32Array(3);
      this.q = new Float32Array(4);
      if (this.fixed) this.place(this.fixed.slice(0, 3), this.fixed.slice(3));
    }

    update(time) {
      if (this.fixed) return;
      const { i, j, w } = this.position.timeline.at(time), q = this.q, all = this.turned;
      this.position.read(time, this.p);
      let along = 0;
      for (let k = 0; k < 4; k++) along += all[4 * i + k] * all[4 * j + k];
      const other = along < 0 ? -w : w;
      for (let k = 0; k < 4; k++) q[k] = (1 - w) * all[4 * i + k] + other * all[4 * j + k];
      this.place(this.p, q);
    }

    place(p, quaternion) {
      const length = Math.hypot(...quaternion), [a, b, c, d] = Array.from(quaternion, (part) => part / length);
      this.matrix.set([
        1 - 2 * (c * c + d * d), 2 * (b * c + a * d), 2 * (b * d - a * c), 0,
        2 * (b * c - a * d), 1 - 2 * (b * b + d * d), 2 * (c * d + a * b), 0,
        2 * (b * d + a * c), 2 * (c * d - a * b), 1 - 2 * (b * b + c * c), 0,
        p[0], p[1], p[2], 1,
      ]);
      this.there = this.matrix.every(Number.isFinite);
      this.group.visible = this.there;
      if (!this.there) return;
      this.group.matrix.fromArray(this.matrix);
      this.group.matrixWorldNeedsUpdate = true;
    }

    point(local, out, offset = 0) { // from axes of the body to the world
      const m = this.matrix, [x, y, z] = local;
      for (let k = 0; k < 3; k++) out[offset + k] = m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k];
      return out;
    }

    local(point) {
      const m = this.matrix, d = [point[0] - m[12], point[1] - m[13], point[2] - m[14]];
      return [0, 1, 2].map((k) => m[4 * k] * d[0] + m[4 * k + 1] * d[1] + m[4 * k + 2] * d[2]);
    }
  }

  const parentOf = (index) => (index < 0 ? root : bodies[index].group);

  // What can be hidden: `name` of what it belongs to, `group` of the list of objects.
  class Item {
    constructor(spec) {
      this.name = spec.name;
      this.group = spec.group;
      this.body = spec.body === undefined ? -1 : spec.body;
      this.hidden = Boolean(spec.hidden);
      this.objects = [];
    }

    show() {
      const other = isolated !== null && isolated !== this.name && this.group !== "water";
      for (const object of this.objects) object.visible = !this.hidden && !other && this.seen !== false;
    }

    update() {}
  }

  class Surface extends Item {
    constructor(spec) {
      super(spec);
      const rest = floats(spec.points);
      this.rest = rest;
      this.shown = spec.modes || spec.shapes ? Float32Array.from(rest) : rest;
      this.coloured = Boolean(spec.stress);
      this.geometry = geometry(this.shown, spec.triangles ? Uint32Array.from(raw(spec.triangles)) : null);
      this.mesh = new three.Mesh(this.geometry, surfaceMaterial(rgb(spec.colour), spec.opacity, this.coloured));
      this.mesh.frustumCulled = false;
      this.mesh.userData.item = this;
      if (spec.coarse) this.indices = [this.geometry.index, new three.Attribute(Uint32Array.from(raw(spec.coarse)), 1)];
      if (spec.opacity < 1) this.mesh.renderOrder = 1;
      parentOf(this.body).add(this.mesh);
      this.objects.push(this.mesh);
      if (spec.edges) {
        const edges = geometry(this.shown, Uint32Array.from(raw(spec.edges)));
        this.geometryOfEdges = edges;
        this.edges = new three.Segments(edges, lineMaterial(0x3a4653));
        this.edges.frustumCulled = false;
        parentOf(this.body).add(this.edges);
        this.objects.push(this.edges);
      }
      if (spec.modes) {
        this.modes = floats(spec.modes);
        this.amplitudes = new Keyed(spec.amplitudes, timelines[spec.timeline]);
        this.a = new Float32Array(this.amplitudes.size);
      } else if (spec.shapes) {
        this.keyed = new Keyed(spec.shapes, timelines[spec.timeline]);
        this.now = new Float32Array(rest.length);
      }
      if (spec.stress) {
        this.stress = new Keyed(spec.stress, timelines[spec.stressTimeline]);
        this.codes = new Float32Array(this.stress.size);
        this.colours = new Uint8Array(3 * this.stress.size);
        this.geometry.setAttribute("color", new three.Attribute(this.colours, 3, true));
      }
      if (spec.anchor) this.anchor = spec.anchor;
      if (spec.offset) this.offset = new Keyed(spec.offset, timelines[spec.offsetTimeline]);
      if (spec.at) this.at = spec.at;
      if (spec.size) this.sized = new Keyed(spec.size, timelines[spec.sizeTimeline]);
      if (this.modes || this.keyed) deformed.push(this);
      this.index = items.length;
      this.d = new Float32Array(3);
    }

    deform(time) {
      const { rest, shown } = this;
      if (this.modes) {
        this.amplitudes.read(time, this.a);
        const { a, modes } = this, count = rest.length;
        shown.set(rest);
        for (let m = 0; m < a.length; m++) {
          const amount = scale * a[m];
          if (amount === 0) continue;
          const start = m * count;
          for (let k = 0; k < count; k++) shown[k] += amount * modes[start + k];
        }
      } else {
        this.keyed.read(time, this.now);
        for (let k = 0; k < rest.length; k++) shown[k] = rest[k] + scale * (this.now[k] - rest[k]);
      }
      this.geometry.attributes.position.needsUpdate = true;
      if (this.geometryOfEdges) this.geometryOfEdges.attributes.position.needsUpdate = true;
    }

    update(time) {
      if (this.stress) {
        this.stress.read(time, this.codes);
        const { codes, colours } = this, table = data.stress.table;
        for (let k = 0; k < codes.length; k++) {
          const entry = table[codes[k] | 0];
          colours[3 * k] = entry[0]; colours[3 * k + 1] = entry[1]; colours[3 * k + 2] = entry[2];
        }
        this.geometry.attributes.color.needsUpdate = true;
      }
      if (this.anchor || this.offset || this.sized) {
        const d = this.d.fill(0);
        if (this.at) d.set(this.at);
        if (this.offset) this.offset.read(time, d);
        if (this.anchor) {
          const { shown, rest } = items[this.anchor[0]], v = 3 * this.anchor[1];
          for (let k = 0; k < 3; k++) d[k] += shown[v + k] - rest[v + k];
        }
        const size = this.sized ? this.sized.read(time, [1])[0] : 1;
        for (const object of this.objects) {
          object.position.set(d[0], d[1], d[2]);
          object.scale.setScalar(Math.max(size, 1e-6));
        }
      }
      if (this.edges) this.edges.visible = this.mesh.visible && options.edges && !LEVELS[level].plain;
      if (this.indices) this.geometry.setIndex(this.indices[LEVELS[level].coarse ? 1 : 0]);
    }
  }

  // A polyline with thickness, six corners around each point; and its line, which is seen from far away too.
  class Tube {
    constructor(parent, count, radius, colour) {
      this.count = count;
      this.radius = radius;
      this.points = new Float32Array(3 * count);
      this.corners = new Float32Array(18 * count);
      const indices = [];
      for (let p = 0; p + 1 < count; p++) {
        for (let k = 0; k < 6; k++) {
          const a = 6 * p + k, b = 6 * p + ((k + 1) % 6);
          indices.push(a, b, b + 6, a, b + 6, a + 6);
        }
      }
      this.geometry = geometry(this.corners, Uint32Array.from(indices));
      this.mesh = new three.Mesh(this.geometry, surfaceMaterial(colour, 1, false));
      const row = Array.from({ length: count - 1 }, (_, p) => [p, p + 1]).flat();
      this.axis = geometry(this.points, Uint32Array.from(row));
      this.line = new three.Segments(this.axis, lineMaterial(colour));
      for (const object of [this.mesh, this.line]) {
        object.frustumCulled = false;
        parent.add(object);
      }
    }

    show(seen) {
      this.mesh.visible = this.line.visible = seen;
    }

    paint(r, g, b) {
      for (const { material } of [this.mesh, this.line]) material.color.setRGB(r, g, b);
    }

    fill() {
      const { points, corners, count, radius } = this;
      let u = [1, 0, 0];
      for (let p = 0; p < count; p++) {
        const a = 3 * Math.max(p - 1, 0), b = 3 * Math.min(p + 1, count - 1);
        const t = [points[b] - points[a], points[b + 1] - points[a + 1], points[b + 2] - points[a + 2]];
        const length = Math.hypot(...t) || 1;
        for (let k = 0; k < 3; k++) t[k] /= length;
        let along = u[0] * t[0] + u[1] * t[1] + u[2] * t[2];
        if (Math.abs(along) > 0.95) {
          u = Math.abs(t[0]) < 0.7 ? [1, 0, 0] : [0, 1, 0];
          along = u[0] * t[0] + u[1] * t[1] + u[2] * t[2];
        }
        u = u.map((part, k) => part - along * t[k]);
        const size = Math.hypot(...u) || 1;
        u = u.map((part) => part / size);
        const v = [t[1] * u[2] - t[2] * u[1], t[2] * u[0] - t[0] * u[2], t[0] * u[1] - t[1] * u[0]];
        for (let c = 0; c < 6; c++) {
          const x = radius * Math.cos((c * Math.PI) / 3), y = radius * Math.sin((c * Math.PI) / 3);
          for (let k = 0; k < 3; k++) corners[18 * p + 3 * c + k] = points[3 * p + k] + x * u[k] + y * v[k];
        }
      }
      this.geometry.attributes.position.needsUpdate = true;
      this.axis.attributes.position.needsUpdate = true;
    }
  }

  // Points that are fixed to bodies, or move in their axes, joined by a tube or by segments.
  class Line extends Item {
    constructor(spec) {
      super(spec);
      this.on = raw(spec.on);
      this.surface = spec.surface ? raw(spec.surface) : null;
      this.vertex = spec.vertex ? raw(spec.vertex) : null;
      this.count = this.on.length;
      if (spec.timeline !== undefined && spec.local.s.length === 3) {
        this.keyed = new Keyed(spec.local, timelines[spec.timeline]);
        this.local = new Float32Array(3 * this.count);
      } else this.local = floats(spec.local);
      this.colour = rgb(spec.colour);
      this.there = new Float32Array(3 * this.count);
      if (spec.coil) this.coil = floats(spec.coil);
      if (spec.radius) {
        this.tube = new Tube(root, this.coil ? this.coil.length / 3 : this.count, spec.radius, this.colour);
        this.objects.push(this.tube.mesh, this.tube.line);
        this.tube.mesh.userData.item = this;
      } else {
        this.geometry = geometry(this.there, Uint32Array.from(raw(spec.ends)));
        this.segments = new three.Segments(this.geometry, lineMaterial(this.colour));
        this.segments.frustumCulled = false;
        root.add(this.segments);
        this.objects.push(this.segments);
      }
      if (spec.tension) {
        this.tension = new Keyed(spec.tension, timelines[spec.tensionTimeline]);
        this.force = [0];
      }
      if (spec.loose) this.loose = { values: raw(spec.loose), timeline: timelines[spec.looseTimeline] };
    }

    update(time) {
      const { local, there } = this;
      if (this.keyed) this.keyed.read(time, local);
      let whole = true;
      for (let p = 0; p < this.count; p++) {
        const at = [local[3 * p], local[3 * p + 1], local[3 * p + 2]];
        if (this.surface && this.surface[p] >= 0) {
          const { shown, rest } = items[this.surface[p]], v = 3 * this.vertex[p];
          for (let k = 0; k < 3; k++) at[k] += shown[v + k] - rest[v + k];
        }
        const body = this.on[p];
        if (body >= 0) {
          whole = whole && bodies[body].there;
          bodies[body].point(at, there, 3 * p);
        } else there.set(at, 3 * p);
        whole = whole && Number.isFinite(there[3 * p]);
      }
      if (this.loose && this.loose.values[this.loose.timeline.at(time).i]) whole = false;
      if (whole !== (this.seen !== false)) {
        this.seen = whole;
        this.show();
      }
      if (!whole) return;
      if (this.tension) {
        const force = this.tension.read(time, this.force)[0];
        const colour = data.tension.table[Math.round(clamp(force / data.tension.largest, 0, 1) * 255)];
        if (colour) this.tube.paint(colour[0] / 255, colour[1] / 255, colour[2] / 255);
      }
      if (this.coil) this.wind();
      else if (this.tube) this.tube.points.set(there);
      if (this.tube) this.tube.fill();
      else this.geometry.attributes.position.needsUpdate = true;
    }

    wind() { // a coil of unit length along z between two points
      const [a, b] = [this.there.slice(0, 3), this.there.slice(3, 6)], points = this.tube.points;
      const e = [b[0] - a[0], b[1] - a[1], b[2] - a[2]], length = Math.hypot(...e) || 1e-9;
      for (let k = 0; k < 3; k++) e[k] /= length;
      const least = e.map(Math.abs).indexOf(Math.min(...e.map(Math.abs)));
      const unit = [0, 1, 2].map((k) => (k === least ? 1 : 0));
      const u = [e[1] * unit[2] - e[2] * unit[1], e[2] * unit[0] - e[0] * unit[2], e[0] * unit[1] - e[1] * unit[0]];
      const size = Math.hypot(...u);
      for (let k = 0; k < 3; k++) u[k] /= size;
      const v = [e[1] * u[2] - e[2] * u[1], e[2] * u[0] - e[0] * u[2], e[0] * u[1] - e[1] * u[0]];
      const r = Math.min(data.radius * 4, 0.125 * length);
      for (let p = 0; p < points.length / 3; p++) {
        const [x, y, z] = this.coil.subarray(3 * p, 3 * p + 3);
        for (let k = 0; k < 3; k++) points[3 * p + k] = a[k] + z * length * e[k] + r * (x * u[k] + y * v[k]);
      }
    }
  }

  // Forces at points: arrows as long as the largest of the run allows.
  class Arrows extends Item {
    constructor(spec) {
      super(spec);
      this.place = new Keyed(spec.place, timelines[spec.timeline]);
      this.force = new Keyed(spec.force, this.place.timeline);
      this.count = this.place.size / 3;
      this.at = new Float32Array(this.place.size);
      this.f = new Float32Array(this.place.size);
      this.longest = spec.longest;
      this.largest = spec.largest;
      const points = [], indices = [], around = 10;
      for (const [radius, z] of [[0.025, 0], [0.025, 0.75], [0.075, 0.75], [0, 1]]) {
        for (let k = 0; k < around; k++) {
          const turn = (2 * Math.PI * k) / around;
          points.push(radius * Math.cos(turn), radius * Math.sin(turn), z);
        }
      }
      for (let ring = 0; ring < 3; ring++) {
        for (let k = 0; k < around; k++) {
          const a = ring * around + k, b = ring * around + ((k + 1) % around);
          indices.push(a, b, b + around, a, b + around, a + around);
        }
      }
      const shape = geometry(Float32Array.from(points), Uint32Array.from(indices));
      const material = surfaceMaterial(rgb(spec.colour), 1, false);
      this.parts = [];
      for (let k = 0; k < this.count; k++) {
        const arrow = new three.Mesh(shape, material);
        arrow.matrixAutoUpdate = false;
        arrow.frustumCulled = false;
        root.add(arrow);
        this.objects.push(arrow);
      }
    }

    update(time) {
      const nearest = this.place.timeline.nearest(time); // between records a contact may be another one
      this.place.read(nearest, this.at);
      this.force.read(nearest, this.f);
      this.objects.forEach((arrow, number) => {
        const f = this.f.subarray(3 * number, 3 * number + 3), size = Math.hypot(...f);
        const length = (this.longest * size) / this.largest;
        const seen = length > 1e-3 * this.longest && Number.isFinite(length);
        arrow.visible = seen && !this.hidden && isolated === null;
        if (!seen) return;
        const e = Array.from(f, (part) => part / size);
        const other = Math.abs(e[0]) < 0.7 ? [1, 0, 0] : [0, 1, 0];
        let u = [e[1] * other[2] - e[2] * other[1], e[2] * other[0] - e[0] * other[2],
          e[0] * other[1] - e[1] * other[0]];
        const norm = Math.hypot(...u);
        u = u.map((part) => part / norm);
        const v = [e[1] * u[2] - e[2] * u[1], e[2] * u[0] - e[0] * u[2], e[0] * u[1] - e[1] * u[0]];
        const w = Math.max(length, 0.3 * this.longest); // short ones stay visible
        arrow.matrix.fromArray([
          ...u.map((part) => part * w), 0, ...v.map((part) => part * w), 0, ...e.map((part) => part * length), 0,
          this.at[3 * number], this.at[3 * number + 1], this.at[3 * number + 2], 1,
        ]);
        arrow.matrixWorldNeedsUpdate = true;
      });
    }
  }

  // The water, with the undisturbed waves.
  class Water extends Item {
    constructor(spec) {
      super({ ...spec, name: "water", group: "water" });
      this.spec = spec;
      const [nx, ny] = spec.cells;
      const points = new Float32Array(3 * (nx + 1) * (ny + 1)), indices = [];
      this.x = Array.from({ length: nx + 1 }, (_, i) => spec.low[0] + ((spec.high[0] - spec.low[0]) * i) / nx);
      this.y = Array.from({ length: ny + 1 }, (_, j) => spec.low[1] + ((spec.high[1] - spec.low[1]) * j) / ny);
      for (let i = 0; i <= nx; i++) {
        for (let j = 0; j <= ny; j++) points.set([this.x[i], this.y[j], spec.level], 3 * (i * (ny + 1) + j));
      }
      for (let i = 0; i < nx; i++) {
        for (let j = 0; j < ny; j++) {
          const a = i * (ny + 1) + j;
          indices.push(a, a + ny + 1, a + ny + 2, a, a + ny + 2, a + 1);
        }
      }
      this.points = points;
      this.geometry = geometry(points, Uint32Array.from(indices));
      this.mesh = new three.Mesh(this.geometry, surfaceMaterial(0x4d8fc4, spec.waves ? 0.55 : 0.4, false));
      this.mesh.frustumCulled = false;
      this.mesh.renderOrder = 2;
      this.mesh.userData.item = this;
      root.add(this.mesh);
      this.objects.push(this.mesh);
      if (spec.waves) {
        this.waves = Object.fromEntries(Object.entries(spec.waves).map(([key, ref]) => [key, floats(ref)]));
        this.tables();
      }
    }

    tables() { // exp(i kx x) and exp(i ky y), which do not change
      const { kx, ky } = this.waves, count = kx.length;
      this.alongX = this.x.map((x) => Float32Array.from({ length: 2 * count }, (_, n) => {
        const turn = kx[n >> 1] * x;
        return n % 2 ? Math.sin(turn) : Math.cos(turn);
      }));
      this.acrossY = this.y.map((y) => Float32Array.from({ length: 2 * count }, (_, n) => {
        const turn = ky[n >> 1] * y;
        return n % 2 ? Math.sin(turn) : Math.cos(turn);
      }));
    }

    update(time) {
      if (!this.waves || this.hidden) return;
      const { amplitude, omega, phase } = this.waves, count = amplitude.length, { points, spec } = this;
      const c = new Float32Array(count), s = new Float32Array(count);
      for (let m = 0; m < count; m++) {
        const turn = omega[m] * time + phase[m];
        c[m] = amplitude[m] * Math.cos(turn);
        s[m] = -amplitude[m] * Math.sin(turn);
      }
      const re = new Float32Array(count), im = new Float32Array(count), columns = this.y.length;
      this.alongX.forEach((along, i) => {
        for (let m = 0; m < count; m++) {
          re[m] = along[2 * m] * c[m] - along[2 * m + 1] * s[m];
          im[m] = along[2 * m] * s[m] + along[2 * m + 1] * c[m];
        }
        for (let j = 0; j < columns; j++) {
          const across = this.acrossY[j];
          let height = spec.level;
          for (let m = 0; m < count; m++) height += re[m] * across[2 * m] - im[m] * across[2 * m + 1];
          points[3 * (i * columns + j) + 2] = height;
        }
      });
      this.geometry.attributes.position.needsUpdate = true;
    }
  }

  // ---- camera

  function depths() { // what is drawn lies between the planes of the camera, wherever it is
    const { camera, controls } = world, far = 40 * data.size + 4 * camera.position.distanceTo(controls.target);
    if (camera.far === far) return;
    camera.far = far;
    camera.near = Math.max(far * 2e-5, 0.01 * camera.position.distanceTo(controls.target));
    camera.updateProjectionMatrix();
  }

  const forward = (name) => ({
    "+x": [1, 0, 0], "-x": [-1, 0, 0], "+y": [0, 1, 0], "-y": [0, -1, 0], "+z": [0, 0, 1], "-z": [0, 0, -1],
  })[name];

  function setCamera(position, target) {
    K3D.setCamera([...position, ...target, ...data.up.vector]);
    world.controls.update();
    dirty = true;
  }

  const distanceFor = (size) => (0.5 * size) / Math.tan((0.5 * world.camera.fov * Math.PI) / 180);

  function view(name) { // from a side, or from where the report looks
    if (isolated !== null) update(); // to where it is at this instant
    const { low, high } = (isolated !== null && boxOf(isolated)) || data.box, middle = low.map((part, k) => 0.5 * (part + high[k]));
    let way = name === "home" ? data.view : forward(name);
    const up = data.up.vector;
    if (Math.abs(way[0] * up[0] + way[1] * up[1] + way[2] * up[2]) > 0.999) {
      // straight from above: a hair beside, so that up remains defined
      const side = Math.abs(up[1]) > 0.5 ? [0, 0, 1] : [0, -1, 0];
      way = way.map((part, k) => part + 1e-3 * side[k]);
    }
    const corners = [];
    for (let k = 0; k < 8; k++) corners.push([k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]]);
    setCamera(fitted(way, middle, corners), middle);
  }

  function fitted(way, middle, corners) { // position from which all corners are seen
    const n = Math.hypot(...way), e = way.map((part) => part / n), up = data.up.vector;
    let right = [up[1] * e[2] - up[2] * e[1], up[2] * e[0] - up[0] * e[2], up[0] * e[1] - up[1] * e[0]];
    const size = Math.hypot(...right);
    right = right.map((part) => part / size);
    const top = [e[1] * right[2] - e[2] * right[1], e[2] * right[0] - e[0] * right[2], e[0] * right[1] - e[1] * right[0]];
    const tangent = Math.tan((0.5 * world.camera.fov * Math.PI) / 180), wide = tangent * Math.max(world.camera.aspect, 0.1);
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let distance = 1e-6;
    for (const corner of corners) {
      const d = corner.map((part, k) => part - middle[k]);
      distance = Math.max(distance, dot(d, e) + (1.08 * Math.abs(dot(d, top))) / tangent,
        dot(d, e) + (1.08 * Math.abs(dot(d, right))) / wide);
    }
    return middle.map((part, k) => part + distance * e[k]);
  }

  function lookAt(point, size = 0) { // from the same side
    const { position } = world.camera, { target } = world.controls;
    const way = [position.x - target.x, position.y - target.y, position.z - target.z], length = Math.hypot(...way) || 1;
    const distance = size > 0 ? Math.min(length, distanceFor(size)) : length;
    setCamera(point.map((part, k) => part + (way[k] / length) * distance), point);
  }

  const PLACE = [0, 0, 0];

  function boxOf(name) { // of all surfaces and lines with a name at this instant
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const item of items) {
      if (item.name !== name) continue;
      const points = item instanceof Surface ? item.shown : item.there, body = bodies[item.body];
      if (!points) continue;
      for (let k = 0; k < points.length; k += 3) {
        const at = points.subarray(k, k + 3);
        const there = item instanceof Surface && body ? body.point(at, PLACE) : at;
        for (let axis = 0; axis < 3; axis++) {
          if (!Number.isFinite(there[axis])) continue;
          low[axis] = Math.min(low[axis], there[axis]);
          high[axis] = Math.max(high[axis], there[axis]);
        }
      }
    }
    return Number.isFinite(low[0]) ? { low, high } : null;
  }

  function show(name) { // bring what has a name into view and mark it
    const found = boxOf(name);
    if (!found) return false;
    const middle = found.low.map((part, k) => 0.5 * (part + found.high[k]));
    const size = Math.hypot(...found.high.map((part, k) => part - found.low[k]));
    lookAt(middle, Math.max(2.5 * size, 0.15 * data.size));
    marked = name;
    overlayDirty = true;
    return true;
  }

  function follow(index) {
    options.follow = index;
    followed = null;
    node("follow").value = String(index);
    dirty = true;
  }

  let followed = null;
  let marked = "";
  let overlayDirty = true;

  function section(axis, share = Number(node("section-place").value)) {
    options.section = axis;
    node("section").value = axis;
    node("section-place").disabled = axis === "";
    if (axis === "") K3D.parameters.clippingPlanes = [];
    else {
      const k = "xyz".indexOf(axis), { low, high } = data.box;
      const place = low[k] + share * (high[k] - low[k]), plane = [0, 0, 0, place];
      plane[k] = -1;
      K3D.parameters.clippingPlanes = [plane];
    }
    dirty = true;
  }

  // ---- picking and measuring

  let ruler = null;

  function pick(event) {
    const box = world.renderer.domElement.getBoundingClientRect();
    const at = { x: ((event.clientX - box.left) / box.width) * 2 - 1, y: 1 - ((event.clientY - box.top) / box.height) * 2 };
    root.updateMatrixWorld(true);
    world.raycaster.setFromCamera(at, world.camera);
    const meshes = items.filter((item) => item.group !== "water").flatMap((item) => item.objects)
      .filter((object) => object.isMesh && object.visible && object.parent.visible);
    for (const mesh of meshes) mesh.geometry.boundingSphere = null; // points have moved
    const plane = K3D.parameters.clippingPlanes[0];
    return world.raycaster.intersectObjects(meshes, false).find(({ point: p }) =>
      !plane || plane[0] * p.x + plane[1] * p.y + plane[2] * p.z + plane[3] >= 0) || null;
  }

  function clicked(event) {
    const hit = pick(event), item = hit && hit.object.userData.item;
    if (options.measure) {
      if (!hit) return;
      if (picks.length === 2) picks = [];
      picks.push(attached(item, hit.point.toArray()));
      dirty = true;
      return;
    }
    marked = item ? item.name : "";
    for (const row of node("objects").querySelectorAll("[data-name]")) {
      row.classList.toggle("marked", row.dataset.name === marked && marked !== "");
    }
    overlayDirty = true;
  }

  function attached(item, point) { // to what was hit, so that the distance is followed in time
    const body = item && bodies[item.body] ? item.body : -1;
    const pin = { body, local: body < 0 ? point : bodies[body].local(point), surface: -1 };
    if (item instanceof Surface && (item.modes || item.keyed)) {
      let best = Infinity;
      for (let v = 0; v < item.shown.length; v += 3) {
        const d = Math.hypot(...[0, 1, 2].map((k) => item.shown[v + k] - pin.local[k]));
        if (d < best) { best = d; pin.vertex = v; }
      }
      pin.surface = item.index;
      pin.local = pin.local.map((part, k) => part - item.shown[pin.vertex + k]);
    }
    return pin;
  }

  function pinned(pin) {
    const local = pin.surface < 0 ? pin.local : pin.local.map((part, k) => part + items[pin.surface].shown[pin.vertex + k]);
    return pin.body < 0 ? local : Array.from(bodies[pin.body].point(local, [0, 0, 0]));
  }

  function measure(on = !options.measure) {
    options.measure = Boolean(on);
    picks = [];
    node("measure").classList.toggle("on", options.measure);
    world.renderer.domElement.style.cursor = options.measure ? "crosshair" : "";
    dirty = true;
  }

  function measured() {
    const words = node("measured");
    ruler.show(picks.length === 2);
    if (!options.measure) words.textContent = "";
    else if (picks.length < 2) words.textContent = `Distance: click ${picks.length ? "the second" : "the first"} point`;
    else {
      const [a, b] = picks.map(pinned), d = b.map((part, k) => part - a[k]);
      ruler.points.set([...a, ...b]);
      ruler.fill();
      words.textContent = `Distance ${number(Math.hypot(...d), 6)} m  (Δx ${number(d[0])}, Δy ${number(d[1])}, Δz ${number(d[2])})`;
    }
  }

  // ---- overlay: labels in the scene, and its axes in a corner

  const AXES = [["x", "#c62828"], ["y", "#2e7d32"], ["z", "#1565c0"]];

  function axes() {
    const canvas = node("axes"), size = 78, dots = window.devicePixelRatio || 1;
    if (canvas.width !== Math.round(size * dots)) canvas.width = canvas.height = Math.round(size * dots);
    const pen = canvas.getContext("2d"), m = world.camera.matrixWorldInverse.elements;
    pen.setTransform(dots, 0, 0, dots, 0.5 * size * dots, 0.5 * size * dots);
    pen.clearRect(-size, -size, 2 * size, 2 * size);
    pen.font = "bold 12px sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.lineWidth = 2;
    const order = AXES.map(([name, colour], k) => ({ name, colour, x: m[4 * k], y: -m[4 * k + 1], near: m[4 * k + 2] }));
    for (const { name, colour, x, y } of order.sort((a, b) => a.near - b.near)) { // what is near covers what is far
      pen.strokeStyle = pen.fillStyle = colour;
      pen.beginPath();
      pen.moveTo(0, 0);
      pen.lineTo(24 * x, 24 * y);
      pen.stroke();
      pen.fillText(name, 32 * x, 32 * y);
    }
  }

  let written = true;

  function overlay() {
    const needed = Boolean(marked) || options.labels;
    if (!needed && !written) return;
    written = needed;
    const canvas = node("overlay"), width = canvas.clientWidth, height = canvas.clientHeight, dots = window.devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * dots) || canvas.height !== Math.round(height * dots)) {
      canvas.width = Math.round(width * dots);
      canvas.height = Math.round(height * dots);
    }
    const pen = canvas.getContext("2d");
    pen.setTransform(dots, 0, 0, dots, 0, 0);
    pen.clearRect(0, 0, width, height);
    if (!world) return;
    pen.font = "12px sans-serif";
    pen.textBaseline = "middle";
    const taken = [], spots = [];
    const write = (text, point, mark) => {
      const at = new three.Vector(...point).project(world.camera);
      if (!(at.z < 1 && Math.abs(at.x) < 1 && Math.abs(at.y) < 1)) return true;
      const x = ((at.x + 1) / 2) * width, place = ((1 - at.y) / 2) * height, wide = pen.measureText(text).width;
      const free = [0, 14, -14, 28, -28, 42, 56].map((away) => place + away).find((row) =>
        !taken.some(([l, r, v]) => l < x + wide + 16 && r > x && Math.abs(v - row) < 14));
      spots.push([x, place, mark]);
      if (free === undefined) return false; // no room for its name
      pen.strokeStyle = mark ? "#c62828" : "#1d2733";
      taken.push([x, x + wide + 16, free]);
      if (free !== place) {
        pen.beginPath();
        pen.moveTo(x, place);
        pen.lineTo(x + 6, free);
        pen.stroke();
      }
      pen.fillStyle = "rgba(255,255,255,0.82)";
      pen.fillRect(x + 6, free - 8, wide + 6, 16);
      pen.fillStyle = mark ? "#c62828" : "#1d2733";
      pen.fillText(text, x + 9, free);
      return true;
    };
    if (marked) {
      const found = boxOf(marked);
      if (found) write(marked, found.low.map((part, k) => 0.5 * (part + found.high[k])), true);
    }
    let dotted = 0;
    for (const label of options.labels ? data.labels : []) {
      if (label.body >= 0 && !bodies[label.body].there) continue;
      if (isolated !== null && label.name !== isolated) continue;
      const at = label.body >= 0 ? bodies[label.body].point(label.point, [0, 0, 0]) : label.point;
      if (!write(label.text, at, false)) dotted++;
    }
    for (const [x, y, mark] of spots) { // on top of the names
      pen.fillStyle = mark ? "#c62828" : "#1d2733";
      pen.beginPath();
      pen.arc(x, y, mark ? 4 : 2.5, 0, 2 * Math.PI);
      pen.fill();
    }
    if (dotted) {
      pen.fillStyle = "#5d6873";
      pen.fillText(`${dotted} ${dotted > 1 ? "names have" : "name has"} no room: come nearer, or isolate an object`, 12, 12);
    }
  }

  // ---- a frame

  function update() {
    const time = clock.now;
    for (const body of bodies) body.update(time);
    for (const surface of deformed) surface.deform(time);
    for (const item of items) item.update(time);
    if (options.follow >= 0 && bodies[options.follow] && bodies[options.follow].there) {
      const body = bodies[options.follow], now = Array.from(body.point(body.centre, [0, 0, 0]));
      const { camera, controls } = world;
      if (followed === null) lookAt(now);
      else {
        const d = now.map((part, k) => part - followed[k]);
        const move = (vector) => vector.set(vector.x + d[0], vector.y + d[1], vector.z + d[2]);
        move(camera.position);
        move(controls.target);
        controls.update();
      }
      followed = now;
    }
    measured();
  }

  // What is given up while playing on a machine that is slow, one after the other; all of it is back when time stands.
  const LEVELS = [
    { ratio: 1, plain: false, coarse: false },
    { ratio: 1, plain: true, coarse: false },
    { ratio: 0.75, plain: true, coarse: false },
    { ratio: 0.75, plain: true, coarse: true },
    { ratio: 0.5, plain: true, coarse: true },
    { ratio: 0.35, plain: true, coarse: true },
  ];

  function setLevel(next) {
    if (next === level || !world) return;
    level = next;
    world.renderer.setPixelRatio((window.devicePixelRatio || 1) * LEVELS[level].ratio);
    dirty = true;
  }

  function sharpen() {
    remembered = level;
    setLevel(0);
  }

  function coarsen(milliseconds) {
    if (remembered > level) setLevel(remembered); // it was needed when last played
    remembered = 0;
    frames.push(milliseconds);
    const mean = frames.reduce((a, b) => a + b, 0) / frames.length;
    if (frames.length < 8 && frames.length * mean < 600) return;
    frames = [];
    if (mean > 36) setLevel(Math.min(level + 1, LEVELS.length - 1));
    else if (mean < 17 && level > 0) setLevel(level - 1);
  }

  let drawn = 0; // frames, for measurements
  let plottedAt = 0;
  const PLOT_EVERY = 120; // milliseconds between two cursors of the plots while the scene is played

  let audio = null; // where the reader has turned the sound on

  function sound() {
    if (audio) audio.close();
    audio = audio ? null : new window.AudioContext();
    node("sound").classList.toggle("on", audio !== null);
  }

  function hear(begin, end) {
    if (!audio) return;
    for (const { time, tone } of data.tones) {
      if ((time > begin || time === clock.begin && begin === time) && time <= end) beep(tone);
    }
  }

  function beep(tone) {
    const source = audio.createOscillator(), loudness = audio.createGain(), now = audio.currentTime;
    source.frequency.value = tone;
    loudness.gain.setValueAtTime(0.2, now);
    loudness.gain.exponentialRampToValueAtTime(0.001, now + 0.5);
    source.connect(loudness).connect(audio.destination);
    source.start(now);
    source.stop(now + 0.5);
  }

  function frame(now) {
    if (clock.playing) {
      const step = (Math.min(now - clock.before, 1000) / 1000) * clock.speed; // not all that passed behind other windows
      if (step > 0) {
        if (world) coarsen(now - clock.before);
        const before = clock.now;
        seek(clock.now + step);
        hear(before, clock.now);
        if (clock.now >= clock.end) play(false);
      }
      clock.before = now;
    }
    if (dirty) {
      dirty = false;
      overlayDirty = true;
      if (world) {
        update();
        K3D.render();
      }
      drawn++;
      readout();
    }
    if (overlayDirty) {
      overlayDirty = false;
      overlay();
      if (world) axes();
    }
    if (plotsDirty && (!clock.playing || now - plottedAt > PLOT_EVERY)) {
      plotsDirty = false;
      plottedAt = now;
      for (const plot of plots) plot.draw();
    }
    window.requestAnimationFrame(frame);
  }

  function readout() {
    const digits = clock.end - clock.begin > 100 ? 2 : 3;
    node("time").textContent = `${clock.now.toFixed(digits)} s`;
    if (document.activeElement !== node("scrub") || clock.playing) {
      node("scrub").value = clock.end > clock.begin ? (clock.now - clock.begin) / (clock.end - clock.begin) : 0;
    }
    const phase = data.phases.filter(([, begin, end]) => begin <= clock.now && clock.now <= end).pop();
    node("phase").textContent = phase ? phase[0] : "";
  }

  // ---- plots

  const COLOURS = ["#1f5fa8", "#c62828", "#2e7d32", "#ef6c00", "#6a1b9a", "#00838f", "#795548", "#ad1457"];
  const plots = [];
  const range = { low: 0, high: 0 }; // of the time shown in all plots

  function channelOf(name) {
    return data.channels.find((channel) => channel.name === name);
  }

  const labelOf = (channel, component) => (channel.components.length > 1
    ? `${channel.name}.${channel.components[component]}` : channel.name);

  // One number over time: component of a channel; with a range where records were left out.
  class Series {
    constructor(channel, component) {
      this.channel = channel;
      this.component = component;
      this.label = labelOf(channel, component);
      this.unit = channel.unit;
      const timeline = timelines[channel.timeline], values = raw(channel.values);
      this.times = timeline.times;
      this.timeline = timeline;
      const width = channel.components.length, count = this.times.length;
      this.ranged = Boolean(channel.ranged);
      this.low = new Float32Array(count);
      this.high = this.ranged ? new Float32Array(count) : this.low;
      for (let i = 0; i < count; i++) {
        if (this.ranged) {
          this.low[i] = values[2 * (i * width + component)];
          this.high[i] = values[2 * (i * width + component) + 1];
        } else this.low[i] = values[i * width + component];
      }
    }

    at(time) {
      const { i, j, w } = this.timeline.at(time);
      if (this.ranged) return [this.low, this.high].map((values) => values[w < 0.5 ? i : j]); // of one interval
      const value = this.low[i] + w * (this.low[j] - this.low[i]);
      return [value, value];
    }

    extreme(side) { // when the largest or smallest value is, and it
      const values = side === "max" ? this.high : this.low;
      let best = -1;
      for (let i = 0; i < values.length; i++) {
        if (Number.isFinite(values[i]) && (best < 0 || (side === "max" ? values[i] > values[best] : values[i] < values[best]))) best = i;
      }
      return best < 0 ? null : [this.times[best], values[best]];
    }
  }

  class Plot {
    constructor() {
      this.series = [];
      this.canvas = make("canvas", { class: "plot", tabindex: "0" });
      this.chosen = ""; // curve whose largest value is looked for; of all if empty
      this.legend = make("div", { class: "legend" });
      this.legend.addEventListener("pointerdown", (event) => {
        const entry = event.target.closest("[data-label]");
        if (!entry) return;
        this.chosen = this.chosen === entry.dataset.label ? "" : entry.dataset.label;
        this.write(...this.unit);
      });
      const tools = make("div", { class: "tools" },
        make("button", { title: "to the largest value of all curves, or of the one whose name is clicked", onclick: () => this.extreme("max") }, "max"),
        make("button", { title: "to the smallest value of all curves, or of the one whose name is clicked", onclick: () => this.extreme("min") }, "min"),
        make("button", { title: "numbers of what is shown", onclick: () => this.csv() }, "csv"),
        make("button", { title: "picture of what is shown", onclick: () => this.png() }, "png"),
        make("button", { title: "all of the time", onclick: () => zoom(clock.begin, clock.end) }, "all"),
        make("button", { title: "remove this plot", onclick: () => this.remove() }, "×"));
      this.box = make("div", { class: "plotbox" }, make("div", { class: "head" }, this.legend, tools), this.canvas);
      node("plots").append(this.box);
      const { canvas } = this;
      let from = null;
      canvas.addEventListener("pointerdown", (event) => {
        from = event.offsetX;
        canvas.setPointerCapture(event.pointerId);
      });
      canvas.addEventListener("pointermove", (event) => {
        this.drag = from !== null && Math.abs(event.offsetX - from) > 5 ? [from, event.offsetX] : null;
        if (from !== null) this.draw();
      });
      canvas.addEventListener("pointerup", (event) => {
        if (from === null) return;
        if (this.drag) {
          const ends = this.drag.map((x) => this.timeAt(x)).sort((a, b) => a - b);
          zoom(...ends);
        } else jump(this.timeAt(event.offsetX));
        from = this.drag = null;
      });
      canvas.addEventListener("dblclick", () => zoom(clock.begin, clock.end));
      canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        const middle = this.timeAt(event.offsetX), factor = event.deltaY > 0 ? 1.25 : 0.8;
        zoom(middle + (range.low - middle) * factor, middle + (range.high - middle) * factor);
      }, { passive: false });
    }

    timeAt(x) {
      const [left, right] = this.ends;
      return clamp(range.low + ((x - left) / (right - left)) * (range.high - range.low), clock.begin, clock.end);
    }

    extreme(side) {
      const own = this.series.filter((series) => series.label === this.chosen);
      const found = (own.length ? own : this.series).map((series) => series.extreme(side)).filter(Boolean);
      const way = side === "max" ? 1 : -1;
      found.sort((a, b) => way * (b[1] - a[1]));
      if (found.length) jump(found[0][0]);
    }

    remove() {
      this.box.remove();
      plots.splice(plots.indexOf(this), 1);
      listPlotted();
    }

    visible(series) { // indices of the records in the range
      const { times } = series;
      let a = series.timeline.at(range.low).i;
      const b = Math.min(series.timeline.at(range.high).j + 1, times.length);
      a = Math.max(0, a);
      return [a, b];
    }

    draw() { // what does not change with time is drawn once
      const { canvas } = this, dots = window.devicePixelRatio || 1;
      const width = canvas.clientWidth || 360, height = canvas.clientHeight || 190;
      const key = [width, height, dots, range.low, range.high, ...this.series.map((series) => series.label)].join(" ");
      if (key !== this.key || !this.back) {
        this.key = key;
        this.back = make("canvas");
        for (const one of [canvas, this.back]) {
          one.width = Math.round(width * dots);
          one.height = Math.round(height * dots);
        }
        this.drawBack(this.back, width, height, dots);
      }
      const pen = canvas.getContext("2d"), [left, right] = this.ends;
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.drawImage(this.back, 0, 0);
      pen.setTransform(dots, 0, 0, dots, 0, 0);
      if (clock.now >= range.low && clock.now <= range.high) {
        const x = left + ((clock.now - range.low) / (range.high - range.low || 1)) * (right - left);
        pen.strokeStyle = "#1d2733";
        pen.lineWidth = 1;
        pen.beginPath();
        pen.moveTo(x, 8);
        pen.lineTo(x, height - 22);
        pen.stroke();
      }
      if (this.drag) {
        pen.fillStyle = "rgba(31,95,168,0.15)";
        pen.fillRect(Math.min(...this.drag), 8, Math.abs(this.drag[1] - this.drag[0]), height - 30);
      }
      this.write(...this.unit);
    }

    drawBack(canvas, width, height, dots) {
      const pen = canvas.getContext("2d");
      pen.setTransform(dots, 0, 0, dots, 0, 0);
      pen.fillStyle = "#fff";
      pen.fillRect(0, 0, width, height);
      let low = Infinity, high = -Infinity;
      for (const series of this.series) {
        const [a, b] = this.visible(series);
        for (let i = a; i < b; i++) {
          if (series.low[i] < low) low = series.low[i];
          if (series.high[i] > high) high = series.high[i];
        }
      }
      const empty = !(Number.isFinite(low) && Number.isFinite(high));
      if (empty) { low = 0; high = 1; }
      const limits = this.limits();
      const span = high - low;
      for (const limit of limits) { // a limit near the curve is seen with it
        if (limit.value > high && limit.value - high < 1.5 * Math.max(span, 0.2 * Math.abs(high))) high = limit.value;
        if (limit.value < low && low - limit.value < 1.5 * Math.max(span, 0.2 * Math.abs(low))) low = limit.value;
      }
      if (high - low <= 1e-6 * Math.max(Math.abs(high), Math.abs(low))) {
        const more = 0.05 * Math.abs(high) || 1;
        low -= more;
        high += more;
      }
      const pad = 0.06 * (high - low);
      low -= pad;
      high += pad;
      const unit = this.series.length ? this.series[0].unit : "";
      const [text, factor] = unitFor(unit, Math.max(Math.abs(low), Math.abs(high)));
      const left = 58, right = width - 10, top = 8, bottom = height - 22;
      this.ends = [left, right];
      const X = (time) => left + ((time - range.low) / (range.high - range.low || 1)) * (right - left);
      const Y = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
      pen.save();
      pen.beginPath();
      pen.rect(left, top, right - left, bottom - top);
      pen.clip();
      data.phases.forEach(([name, begin, end], number) => {
        pen.fillStyle = number % 2 ? "#f3f6fa" : "#e6edf5";
        pen.fillRect(X(begin), top, X(end) - X(begin), bottom - top);
        pen.fillStyle = "#7b8794";
        pen.font = "10px sans-serif";
        if (X(end) - X(begin) > 40) pen.fillText(name, X(begin) + 3, top + 10, X(end) - X(begin) - 6);
      });
      pen.restore();
      pen.font = "10.5px sans-serif";
      pen.fillStyle = "#5d6873";
      pen.strokeStyle = "#e1e6eb";
      pen.lineWidth = 1;
      pen.textAlign = "right";
      pen.textBaseline = "middle";
      for (const [tick, words] of ticks(low / factor, high / factor, 5)) {
        const y = Y(tick * factor);
        pen.beginPath();
        pen.moveTo(left, y);
        pen.lineTo(right, y);
        pen.stroke();
        pen.fillText(words, left - 5, y, left - 8);
      }
      pen.textAlign = "center";
      pen.textBaseline = "top";
      for (const [tick, words] of ticks(range.low, range.high, 6)) {
        pen.beginPath();
        pen.moveTo(X(tick), top);
        pen.lineTo(X(tick), bottom);
        pen.stroke();
        pen.fillText(words, X(tick), bottom + 5);
      }
      pen.textAlign = "right";
      pen.fillText("t [s]", left - 14, bottom + 5);
      pen.save();
      pen.beginPath();
      pen.rect(left, top, right - left, bottom - top);
      pen.clip();
      for (const limit of limits) {
        pen.strokeStyle = "#b71c1c";
        pen.setLineDash([6, 4]);
        pen.beginPath();
        pen.moveTo(left, Y(limit.value));
        pen.lineTo(right, Y(limit.value));
        pen.stroke();
        pen.setLineDash([]);
        pen.fillStyle = "#b71c1c";
        pen.textAlign = "right";
        const y = clamp(Y(limit.value), top + 12, bottom - 3);
        const where = limit.value > high ? " ↑" : limit.value < low ? " ↓" : "";
        pen.textBaseline = "bottom";
        pen.fillText(`${limit.name} ${number(limit.value / factor)} ${text}${where}`, right - 3, y - 1);
      }
      this.series.forEach((series, order) => {
        const colour = COLOURS[order % COLOURS.length], [a, b] = this.visible(series), { times } = series;
        pen.strokeStyle = colour;
        pen.lineWidth = 1.4;
        if (series.ranged) {
          pen.fillStyle = `${colour}44`;
          pen.beginPath();
          for (let i = a; i < b; i++) pen.lineTo(X(times[i]), Y(series.high[i]));
          for (let i = b - 1; i >= a; i--) pen.lineTo(X(times[i]), Y(series.low[i]));
          pen.fill();
        }
        for (const values of series.ranged ? [series.low, series.high] : [series.low]) {
          pen.beginPath();
          let pen_down = false;
          const step = Math.max(1, Math.floor((b - a) / (1.5 * (right - left))));
          for (let i = a; i < b; i++) {
            if (step > 1) { // many records a pixel: their range
              const end = Math.min(i + step, b);
              let least = Infinity, most = -Infinity;
              for (let k = i; k < end; k++) { least = Math.min(least, values[k]); most = Math.max(most, values[k]); }
              const x = X(times[i]);
              if (pen_down) pen.lineTo(x, Y(least)); else pen.moveTo(x, Y(least));
              pen.lineTo(x, Y(most));
              pen_down = true;
              i = end - 1;
            } else if (!Number.isFinite(values[i])) pen_down = false;
            else if (pen_down) pen.lineTo(X(times[i]), Y(values[i]));
            else { pen.moveTo(X(times[i]), Y(values[i])); pen_down = true; }
          }
          pen.stroke();
        }
      });
      pen.restore();
      pen.strokeStyle = "#b8c0c8";
      pen.strokeRect(left, top, right - left, bottom - top);
      if (empty) {
        pen.fillStyle = "#5d6873";
        pen.textAlign = "center";
        pen.fillText("no data in this range", 0.5 * (left + right), 0.5 * (top + bottom));
      }
      this.unit = [text, factor];
    }

    limits() {
      const shown = new Set(this.series.map((series) => series.label));
      return data.limits.filter((limit) => shown.has(limit.series));
    }

    write(text, factor) { // names and values at the cursor
      const entries = this.series.map((series, order) => {
        const [low, high] = series.at(clock.now);
        const value = series.ranged && high > low ? `${number(low / factor)} … ${number(high / factor)}` : number(low / factor);
        const dot = make("span", { class: "dot" });
        dot.style.background = COLOURS[order % COLOURS.length];
        const marked = series.label === this.chosen ? " chosen" : "";
        return make("span", { class: `entry${marked}`, "data-label": series.label }, dot, `${series.label} `, make("b", {}, `${value} ${text}`.trim()));
      });
      this.legend.replaceChildren(...entries);
    }

    table() { // rows of numbers of what is shown; a block of columns for each timeline
      const blocks = new Map();
      for (const series of this.series) {
        if (!blocks.has(series.timeline)) blocks.set(series.timeline, []);
        blocks.get(series.timeline).push(series);
      }
      const columns = [];
      for (const [timeline, own] of blocks) {
        const inside = [];
        timeline.times.forEach((time, i) => { if (time >= range.low && time <= range.high) inside.push(i); });
        columns.push(["time [s]", inside.map((i) => Number(timeline.times[i].toPrecision(12)))]);
        for (const series of own) {
          const unit = series.unit ? ` [${series.unit}]` : "";
          if (series.ranged) {
            columns.push([`smallest of ${series.label}${unit}`, inside.map((i) => shortest(series.low[i]))]);
            columns.push([`largest of ${series.label}${unit}`, inside.map((i) => shortest(series.high[i]))]);
          } else columns.push([`${series.label}${unit}`, inside.map((i) => shortest(series.low[i]))]);
        }
      }
      const rows = Math.max(0, ...columns.map(([, values]) => values.length));
      const cell = (value) => (value === undefined || Number.isNaN(value) ? "" : String(value));
      const quoted = (name) => `"${name.replaceAll('"', '""')}"`;
      const lines = [columns.map(([name]) => quoted(name)).join(",")];
      for (let row = 0; row < rows; row++) lines.push(columns.map(([, values]) => cell(values[row])).join(","));
      return `${lines.join("\r\n")}\r\n`;
    }

    csv() {
      save(new Blob([this.table()], { type: "text/csv" }), "csv");
    }

    png() {
      const { canvas } = this, head = 16 * this.series.length + 6, dots = window.devicePixelRatio || 1;
      const picture = make("canvas");
      picture.width = canvas.width;
      picture.height = canvas.height + Math.round(head * dots);
      const pen = picture.getContext("2d");
      pen.fillStyle = "#fff";
      pen.fillRect(0, 0, picture.width, picture.height);
      pen.drawImage(canvas, 0, Math.round(head * dots));
      pen.setTransform(dots, 0, 0, dots, 0, 0);
      pen.font = "12px sans-serif";
      this.series.forEach((series, order) => {
        pen.fillStyle = COLOURS[order % COLOURS.length];
        pen.fillText(this.legend.children[order].textContent, 10, 16 * (order + 1));
      });
      picture.toBlob((blob) => save(blob, "png"));
    }
  }

  const saved = []; // what was given to the browser to store, for tests

  function save(blob, ending) {
    const name = `${data.case}_${new Date().toISOString().slice(0, 19).replaceAll(":", "")}.${ending}`;
    const link = make("a", { href: URL.createObjectURL(blob), download: name });
    document.body.append(link);
    link.click();
    link.remove();
    saved.push({ name, size: blob.size });
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  function ticks(low, high, count) { // places, and words with as many decimals as the step has
    const rough = (high - low) / count;
    if (!(rough > 0) || !Number.isFinite(rough)) return [];
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((part) => part * power).find((part) => part >= rough);
    const places = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)), found = [];
    for (let k = Math.ceil(low / step); k <= Math.floor(high / step + 1e-9) && found.length < 50; k++) {
      const tick = k * step;
      found.push([tick, places > 6 || Math.abs(tick) >= 1e7 ? number(tick) : tick.toFixed(places)]);
    }
    return found;
  }

  function zoom(low, high) {
    const least = 1e-6 * (clock.end - clock.begin);
    range.low = clamp(low, clock.begin, clock.end);
    range.high = clamp(high, clock.begin, clock.end);
    if (range.high - range.low < least) [range.low, range.high] = [clock.begin, clock.end];
    plotsDirty = true;
  }

  // Plot a component, in a plot of the same unit if there is one and `apart` is not asked for.
  function plot(name, component = 0, apart = false) {
    const channel = channelOf(name);
    if (!channel) return null;
    const series = new Series(channel, component);
    const shown = plots.find((one) => one.series.some((own) => own.label === series.label));
    if (shown) return shown;
    let target = apart ? null : plots.find((one) => one.series.length < 8 && one.series[0].unit === series.unit
      && one.series[0].channel.name.split(".").pop() === name.split(".").pop());
    if (!target) {
      target = new Plot();
      plots.push(target);
    }
    target.series.push(series);
    plotsDirty = true;
    listPlotted();
    return target;
  }

  function unplot(label) {
    for (const one of [...plots]) {
      one.series = one.series.filter((series) => series.label !== label);
      if (!one.series.length) one.remove();
    }
    plotsDirty = true;
    listPlotted();
  }

  // ---- lists: checks, channels, objects

  function say(text) {
    node("notes").append(make("p", {}, text));
  }

  function listChecks() {
    const rows = data.checks.map((check, number) => {
      const state = check.passed === null ? "open" : check.passed ? "passed" : "failed";
      const row = make("tr", { class: state, tabindex: "0", "data-check": check.name, title: "to the instant and place" },
        make("td", {}, check.name), make("td", { class: "number" }, check.value), make("td", { class: "number" }, check.limit),
        make("td", { class: "number" }, check.used),
        make("td", {}, check.where), make("td", { class: "result" }, check.result));
      const go = () => govern(number);
      row.addEventListener("click", go);
      row.addEventListener("keydown", (event) => { if (event.key === "Enter") go(); });
      return row;
    });
    node("checks").replaceChildren(...rows);
    node("checkbox").hidden = !rows.length;
  }

  function govern(number) { // go to where and when a check governs
    const check = data.checks[number];
    if (check.series) plot(check.series[0], check.series[1]);
    if (check.time !== null) jump(check.time);
    dirty = true;
    if (world) {
      update();
      check.places.some((place) => show(place));
    }
  }

  const opened = (list) => new Map([...list.querySelectorAll("[data-of]")].map((box) => [box.dataset.of, box.open]));

  function listChannels() {
    const words = node("filter").value.toLowerCase().split(/\s+/).filter(Boolean);
    const owners = new Map();
    for (const channel of data.channels) {
      if (!words.every((word) => channel.name.toLowerCase().includes(word))) continue;
      const owner = channel.name.includes("(") ? "combinations" : channel.name.split(".")[0];
      if (!owners.has(owner)) owners.set(owner, []);
      owners.get(owner).push(channel);
    }
    const list = node("channels"), { scrollTop } = list, open = opened(list), parts = [];
    for (const [owner, channels] of owners) {
      const box = make("details", { "data-of": owner }, make("summary", {}, owner));
      box.open = words.length > 0 || Boolean(open.get(owner));
      const fill = () => { // made when it is opened: there may be thousands
        if (box.childElementCount > 1) return;
        for (const channel of channels) {
          const unit = channel.unit && channel.unit !== "1" ? ` [${channel.unit}]` : "";
          const title = channel.name.startsWith(`${owner}.`) ? channel.name.slice(owner.length + 1) : channel.name;
          const row = make("div", { class: "channel" }, make("span", { title: channel.description || channel.name }, `${title}${unit} `));
          channel.components.forEach((component, index) => {
            const label = labelOf(channel, index);
            const button = make("button", { "data-series": label }, channel.components.length > 1 ? component : "plot");
            button.addEventListener("click", (event) => {
              if (button.classList.contains("on")) unplot(label); else plot(channel.name, index, event.shiftKey);
            });
            row.append(button);
          });
          box.append(row);
        }
        listPlotted();
      };
      box.addEventListener("toggle", fill);
      if (box.open) fill();
      parts.push(box);
    }
    list.replaceChildren(...parts);
    list.scrollTop = scrollTop;
    listPlotted();
    if (!parts.length) list.textContent = data.channels.length ? "no such channel" : "no channels";
  }

  function listPlotted() {
    const shown = new Set(plots.flatMap((one) => one.series.map((series) => series.label)));
    for (const button of node("channels").querySelectorAll("[data-series]")) {
      button.classList.toggle("on", shown.has(button.dataset.series));
    }
  }

  function listObjects() {
    const groups = new Map();
    for (const item of items) {
      if (!groups.has(item.group)) groups.set(item.group, new Map());
      const names = groups.get(item.group);
      if (!names.has(item.name)) names.set(item.name, []);
      names.get(item.name).push(item);
    }
    const open = opened(node("objects")), parts = [];
    for (const [group, names] of groups) {
      const rows = [...names].map(([name, own]) => {
        const seen = make("input", { type: "checkbox", title: "shown", "aria-label": `show ${name}` });
        seen.checked = own.some((item) => !item.hidden);
        seen.addEventListener("change", () => {
          for (const item of own) { item.hidden = !seen.checked; item.show(); }
          dirty = true;
        });
        const only = make("button", { title: "show this alone, or all again" }, "only");
        only.addEventListener("click", () => isolate(isolated === name ? null : name));
        const title = make("span", { class: "name", title: "bring into view" }, name);
        title.addEventListener("click", () => show(name));
        return make("div", { class: "object", "data-name": name }, seen, title, only);
      });
      const all = make("input", { type: "checkbox", "aria-label": `show ${group}` });
      all.checked = [...names.values()].flat().some((item) => !item.hidden);
      all.addEventListener("change", () => {
        for (const item of [...names.values()].flat()) { item.hidden = !all.checked; item.show(); }
        listObjects();
        dirty = true;
      });
      const box = make("details", { "data-of": group }, make("summary", {}, all, ` ${group} (${names.size})`), ...rows);
      box.open = open.get(group) ?? names.size <= 12;
      parts.push(box);
    }
    node("objects").replaceChildren(...parts);
  }

  function isolate(name) {
    isolated = name;
    for (const item of items) item.show();
    for (const row of node("objects").querySelectorAll("[data-name]")) row.classList.toggle("marked", row.dataset.name === name);
    dirty = true;
  }

  function legends() {
    const parts = [];
    const bar = (title, table, ends) => {
      const strip = make("canvas", { width: "12", height: "120" }), pen = strip.getContext("2d");
      for (let y = 0; y < 120; y++) {
        const [r, g, b] = table[Math.min(255, Math.floor((255 * (119 - y)) / 119))];
        pen.fillStyle = `rgb(${r},${g},${b})`;
        pen.fillRect(0, y, 12, 1);
      }
      const marks = make("div", { class: "marks" }, ...ends.map((end) => make("span", {}, end)));
      return make("div", { class: "bar" }, make("div", { class: "title" }, title), make("div", { class: "strip" }, strip, marks));
    };
    const five = (low, high, factor) => [4, 3, 2, 1, 0].map((k) => number((low + ((high - low) * k) / 4) / factor, 3));
    if (data.stress) {
      const { low, high, title, unit, largest, table } = data.stress, ends = five(low, high, 1);
      parts.push(bar(`${title} [${unit}]${largest > high ? `, largest ${number(largest, 3)}` : ""}`, table, ends));
    }
    if (data.tension) {
      const [unit, factor] = unitFor("N", data.tension.largest);
      parts.push(bar(`tension [${unit}]`, data.tension.table, five(0, data.tension.largest, factor)));
    }
    const peak = data.arrows.reduce((most, one) => Math.max(most, one.largest), 0);
    if (peak > 0) {
      const [unit, factor] = unitFor("N", peak);
      parts.push(make("div", { class: "bar" }, `longest arrow ${number(peak / factor, 3)} ${unit}`));
    }
    node("legend").replaceChildren(...parts);
  }

  // ---- keys and buttons

  const KEYS = [
    ["space", "play or pause"], ["← →", "one record back or on"], ["shift ← →", "a second"], ["home end", "begin and end"],
    ["[ ]", "event before and after"], ["− +", "slower, faster"], ["h", "whole scene"], ["1 to 6", "views from the sides"],
    ["f", "follow the marked body, or nothing"], ["i", "isolate the marked object, or show all"], ["l", "labels"],
    ["e", "edges"], ["m", "measure a distance"], ["x y z", "section plane, again to remove it"], ["?", "this list"], ["esc", "nothing marked"],
  ];

  function key(event) {
    const at = event.target;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (at.tagName === "INPUT" && at.type === "search") return;
    if (at.tagName === "SELECT" && event.key !== "Escape") return;
    const sides = ["-y", "+y", "+x", "-x", "+z", "-z"];
    const actions = {
      " ": () => play(),
      ArrowRight: () => (event.shiftKey ? jump(clock.now + 1) : nextRecord(1)),
      ArrowLeft: () => (event.shiftKey ? jump(clock.now - 1) : nextRecord(-1)),
      Home: () => jump(clock.begin), End: () => jump(clock.end),
      "]": () => nextEvent(1), "[": () => nextEvent(-1),
      "+": () => speed(clock.speed * 2), "=": () => speed(clock.speed * 2), "-": () => speed(clock.speed / 2),
      h: () => view("home"), l: () => toggle("labels"), e: () => toggle("edges"), m: () => measure(),
      f: () => follow(options.follow >= 0 ? -1 : bodies.findIndex((body) => body.name === marked)),
      i: () => isolate(isolated !== null ? null : marked || null),
      x: () => section(options.section === "x" ? "" : "x"), y: () => section(options.section === "y" ? "" : "y"),
      z: () => section(options.section === "z" ? "" : "z"),
      "?": () => node("help").toggleAttribute("hidden"),
      Escape: () => { marked = ""; isolate(null); measure(false); node("help").hidden = true; },
    };
    const needsScene = !" ArrowRight ArrowLeft Home End ] [ + = - ?".split(" ").includes(event.key) && event.key !== " ";
    const action = /^[1-6]$/.test(event.key) ? () => view(sides[Number(event.key) - 1]) : actions[event.key];
    if (!action || (needsScene && !world)) return;
    event.preventDefault();
    action();
  }

  function toggle(what) {
    options[what] = !options[what];
    node(what).classList.toggle("on", options[what]);
    for (const item of items) item.show();
    dirty = overlayDirty = true;
  }

  function speed(value) {
    clock.speed = clamp(value, 1 / 64, 64);
    const select = node("speed"), text = String(clock.speed);
    if (![...select.options].some((option) => option.value === text)) {
      select.append(make("option", { value: text }, `× ${number(clock.speed, 3)}`));
    }
    select.value = text;
  }

  function controls() {
    node("play").addEventListener("click", () => play());
    node("scrub").addEventListener("input", () => jump(clock.begin + Number(node("scrub").value) * (clock.end - clock.begin)));
    node("speed").addEventListener("change", () => speed(Number(node("speed").value)));
    node("events").addEventListener("change", () => {
      if (node("events").value !== "") jump(Number(node("events").value));
      node("events").value = "";
    });
    node("sound").addEventListener("click", () => sound());
    node("filter").addEventListener("input", listChannels);
    node("view").addEventListener("change", () => { view(node("view").value); node("view").value = ""; });
    node("follow").addEventListener("change", () => follow(Number(node("follow").value)));
    node("section").addEventListener("change", () => section(node("section").value));
    node("section-place").addEventListener("input", () => section(options.section));
    node("scale").addEventListener("change", () => { scale = Number(node("scale").value); dirty = true; });
    node("labels").addEventListener("click", () => toggle("labels"));
    node("edges").addEventListener("click", () => toggle("edges"));
    node("measure").addEventListener("click", () => measure());
    node("keys").addEventListener("click", () => node("help").toggleAttribute("hidden"));
    node("help").replaceChildren(...KEYS.map(([name, what]) => make("div", {}, make("kbd", {}, name), ` ${what}`)));
    for (const tab of document.querySelectorAll("#hl [data-tab]")) {
      tab.addEventListener("click", () => {
        for (const other of document.querySelectorAll("#hl [data-tab]")) {
          other.classList.toggle("on", other === tab);
          node(other.dataset.tab).hidden = other !== tab;
        }
        plotsDirty = true;
      });
    }
    node("app").addEventListener("keydown", key);
    document.addEventListener("keydown", (event) => { if (event.target === document.body) key(event); });
    window.addEventListener("resize", () => { dirty = plotsDirty = true; });
  }

  function fillControls() {
    node("events").replaceChildren(make("option", { value: "" }, "jump to…"),
      ...data.events.map((event) => make("option", { value: String(event.time) }, `${number(event.time, 6)} s  ${event.text}`)));
    node("events").disabled = !data.events.length;
    node("sound").hidden = !data.tones.length || !window.AudioContext;
    node("follow").replaceChildren(make("option", { value: "-1" }, "follow nothing"),
      ...data.bodies.map((body, index) => make("option", { value: String(index) }, `follow ${body.name}`)));
    node("follow").value = String(options.follow);
    const scales = data.scales;
    node("scale").replaceChildren(...scales.map((value) => make("option", { value: String(value) }, `× ${value} deformation`)));
    node("scale").hidden = scales.length < 2;
    if (!scales.includes(scale)) scale = data.scale;
    node("scale").value = String(scale);
    const verdict = node("verdict");
    verdict.textContent = data.verdict.text;
    verdict.className = data.verdict.passed === null ? "open" : data.verdict.passed ? "passed" : "failed";
    node("title").textContent = data.title;
    node("below").hidden = document.getElementById("report") === null;
    const notes = [...(trouble ? [trouble] : []), ...data.notes];
    node("notes").replaceChildren(...notes.map((text) => make("p", {}, text)));
    document.querySelector('#hl [data-tab="notepane"]').textContent = notes.length ? `about (${notes.length})` : "about";
    node("player").hidden = !(clock.end > clock.begin);
  }

  // ---- start

  function take(header, block) {
    data = header;
    bytes = block;
    timelines = data.timelines.map((ref) => new Timeline(ref));
    const atEnd = clock.end > clock.begin && clock.now >= clock.end;
    clock.begin = data.begin;
    clock.end = data.end;
    if (atEnd && data.live) clock.now = clock.end;
    clock.now = clamp(clock.now, clock.begin, clock.end);
  }

  let offered = false; // curves that are plotted at first

  function fill() {
    fillControls();
    if (world) {
      build();
      legends();
      listObjects();
      for (const item of items) item.show();
    }
    listChecks();
    listChannels();
    const shown = plots.map((one) => one.series.map((series) => [series.channel.name, series.component]));
    plots.length = 0;
    node("plots").replaceChildren();
    for (const own of shown) {
      let first = true;
      for (const [name, component] of own) {
        plot(name, component, first);
        first = false;
      }
    }
    const tab = (name) => document.querySelector(`#hl [data-tab="${name}"]`).click();
    if (!data.channels.length) tab("objectpane");
    else if (!offered) { // at first, and when the first records of a run come
      offered = true;
      tab("plotpane");
      for (const [name, component] of data.plotted) plot(name, component);
    }
    dirty = plotsDirty = overlayDirty = true;
  }

  async function renew() { // of a run that goes on
    const answer = await fetch("data", { cache: "no-store" });
    if (!answer.ok) return;
    const packed = new Uint8Array(await answer.arrayBuffer()), length = new DataView(packed.buffer).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(packed.subarray(4, 4 + length)));
    const all = range.low <= clock.begin && range.high >= clock.end, empty = !data.surfaces.length;
    take(header, await inflated(packed.subarray(4 + length)));
    if (all) zoom(clock.begin, clock.end);
    fill();
    if (world && empty) { // now it is known what there is to be seen
      K3D.setCameraUpAxis(data.up.axis);
      update();
      view("home");
    }
  }

  async function watch() {
    let version = data.version;
    const stop = node("stop");
    stop.hidden = false;
    node("progress").hidden = false;
    stop.addEventListener("click", async () => {
      stop.disabled = true;
      await fetch("stop", { method: "POST", headers: { "X-Heavylift": data.live } });
    });
    for (;;) {
      await new Promise((done) => setTimeout(done, 1000));
      let state = null;
      try {
        state = await (await fetch("progress", { cache: "no-store" })).json();
      } catch {
        node("progress").textContent = "the run is no longer watched: its command has ended";
        stop.hidden = true;
        return;
      }
      node("progress").textContent = state.text;
      stop.hidden = !state.running;
      if (state.version !== version) {
        version = state.version;
        try {
          await renew();
        } catch (error) {
          say(`The new records cannot be shown: ${error.message}`);
        }
      }
    }
  }

  let trouble = ""; // why there is no scene
  const state = { ready: false, error: "" };

  async function start() {
    const begin = performance.now();
    try {
      const block = await inflated(bytesOf(node("block").textContent.trim()));
      take(JSON.parse(node("header").textContent), block);
      clock.now = clock.begin;
      [range.low, range.high] = [clock.begin, clock.end];
      scale = data.scale;
      options.labels = Boolean(data.labelled);
      controls();
      speed(1);
      try {
        const text = new TextDecoder().decode(await inflated(bytesOf(node("library").textContent.trim())));
        const define = (_name, _needs, factory) => { library = factory(); };
        define.amd = {};
        new Function("define", text)(define);
        await openCanvas();
      } catch (error) {
        world = null;
        trouble = `No scene in three dimensions: ${error.message}. Plots, tables and pictures are complete.`;
        node("canvas").replaceChildren(make("p", { class: "none" }, trouble));
      }
      fill();
      node("labels").classList.toggle("on", options.labels);
      node("edges").classList.toggle("on", options.edges);
      if (world) {
        update();
        view("home");
      }
      window.requestAnimationFrame(frame);
      state.ready = true;
      state.seconds = (performance.now() - begin) / 1000;
      if (data.live) watch();
    } catch (error) {
      state.error = String(error && error.stack ? error.stack : error);
      const words = make("p", { class: "failed" }, `The interactive part cannot be shown (${error.message}); pictures and tables are below.`);
      document.getElementById("hl").prepend(words);
    }
  }

  // What others may ask of the page.
  return {
    state, start, seek: jump, play, view, show, govern, isolate, follow, section, measure, plot, unplot, zoom, speed, clock, plots,
    saved, options,
    position: (name, point = [0, 0, 0]) => {
      const body = bodies.find((one) => one.name === name);
      if (!body) return null;
      update();
      return Array.from(body.point(point, [0, 0, 0]));
    },
    points: (name) => {
      update();
      return items.filter((item) => item.name === name).map((item) => Array.from(item instanceof Surface ? item.shown : item.there || []));
    },
    there: (name) => bodies.some((body) => body.name === name && body.there),
    visible: (name) => items.some((item) => item.name === name && item.objects.some((object) => object.visible)),
    camera: () => ({ array: Array.from(world.controls.getCameraArray()), fov: world.camera.fov, aspect: world.camera.aspect }),
    drawn: () => drawn,
    level: () => level,
    header: () => data,
    picks: () => picks.map(pinned),
    range,
    scaled: (value) => { scale = value; dirty = true; },
    table: (number) => plots[number].table(),
  };
})();

window.heavylift = heavylift;
heavylift.start();
