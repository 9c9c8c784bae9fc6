// What WebGL2 is told: solids one by one, lines all at once.

/** Numbers of a line in its buffer: from, to, colour, width and dash. */
const LINE_NUMBERS = 12;

/** Lines that are gathered before they are drawn. */
class Lines {
  constructor() {
    this.numbers = new Float32Array(1024 * LINE_NUMBERS);
    this.count = 0;
  }

  /** A line between two points relative to the camera's target, m; width and dash in pixels of the screen. */
  add(from, to, colour, opacity, width, dash = 0) {
    const at = this.count * LINE_NUMBERS;
    if (at + LINE_NUMBERS > this.numbers.length) {
      const larger = new Float32Array(2 * this.numbers.length);
      larger.set(this.numbers);
      this.numbers = larger;
    }
    this.numbers.set(from, at);
    this.numbers.set(to, at + 3);
    this.numbers.set(colour, at + 6);
    this.numbers[at + 9] = opacity;
    this.numbers[at + 10] = width;
    this.numbers[at + 11] = dash;
    this.count += 1;
  }

  clear() {
    this.count = 0;
  }
}

/** The graphics card, or nothing where there is no WebGL2. */
class Drawing {
  static on(canvas) {
    const options = { antialias: true, alpha: false, powerPreference: 'high-performance' };
    const gl = canvas.getContext('webgl2', options);
    return gl ? new Drawing(gl) : undefined;
  }

  constructor(gl) {
    this.gl = gl;
    this.solids = program(gl, SOLID_VERTEX, SOLID_FRAGMENT);
    this.strokes = program(gl, LINE_VERTEX, LINE_FRAGMENT);
    const upload = (mesh) => uploadMesh(gl, this.solids, mesh);
    this.meshes = { sphere: upload(sphereMesh()), box: upload(boxMesh()), cylinder: upload(cylinderMesh()) };
    this.buffer = gl.createBuffer();
    this.lineArrays = lineArrays(gl, this.strokes, this.buffer);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.clearColor(1, 1, 1, 1);
  }

  /** Begins a picture as a camera sees it; `ratio` is pixels of the canvas for one of the page. */
  begin(camera, ratio) {
    const { gl } = this;
    this.camera = camera;
    this.ratio = ratio;
    this.matrix = camera.matrix();
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  /** A solid: its kind, size along its axes, centre relative to the target, attitude, and look. */
  solid({ kind, size, centre, attitude, colour, opacity, hatched }) {
    const { gl, solids } = this;
    const mesh = this.meshes[kind];
    gl.useProgram(solids.program);
    gl.uniformMatrix4fv(solids.at('to_clip'), false, this.matrix);
    gl.uniformMatrix3fv(solids.at('turn'), false, rotationMatrix(attitude));
    gl.uniform3fv(solids.at('size'), size);
    gl.uniform3fv(solids.at('centre'), centre);
    gl.uniform4f(solids.at('colour'), ...colour, opacity);
    gl.uniform3fv(solids.at('to_eye'), this.camera.axes().toEye);
    gl.uniform1i(solids.at('hatched'), hatched ? 1 : 0);
    gl.uniform1i(solids.at('quartered'), kind === 'box' ? 0 : 1);
    gl.depthMask(opacity === 1);
    gl.bindVertexArray(mesh.array);
    gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_SHORT, 0);
    gl.depthMask(true);
  }

  /** Draws lines: on top of everything, behind everything, or where they are. */
  lines(lines, order) {
    const { gl, strokes } = this;
    if (lines.count === 0) return;
    gl.useProgram(strokes.program);
    gl.uniformMatrix4fv(strokes.at('to_clip'), false, this.matrix);
    const [width, height] = [gl.drawingBufferWidth / this.ratio, gl.drawingBufferHeight / this.ratio];
    gl.uniform2f(strokes.at('pixels'), width, height);
    gl.uniform1f(strokes.at('nearest'), this.camera.nearest());
    gl.uniform1f(strokes.at('forward'), order === 'there' ? 1e-5 : 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, lines.numbers.subarray(0, lines.count * LINE_NUMBERS), gl.DYNAMIC_DRAW);
    gl.disable(gl.CULL_FACE);
    gl.depthMask(false);
    if (order !== 'there') gl.disable(gl.DEPTH_TEST);
    gl.bindVertexArray(this.lineArrays);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, lines.count);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    gl.depthMask(true);
  }
}

/** A program, and where its uniforms and attributes are. */
function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`a program of the view is refused: ${gl.getProgramInfoLog(made)}`);
  }
  const places = new Map();
  const at = (name) => {
    if (!places.has(name)) places.set(name, gl.getUniformLocation(made, name));
    return places.get(name);
  };
  return { program: made, at, input: (name) => gl.getAttribLocation(made, name) };
}

function uploadMesh(gl, solids, mesh) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  for (const [name, numbers] of [['position', mesh.positions], ['normal', mesh.normals]]) {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(solids.input(name));
    gl.vertexAttribPointer(solids.input(name), 3, gl.FLOAT, false, 0, 0);
  }
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(mesh.indices), gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  return { array, count: mesh.indices.length };
}

function lineArrays(gl, strokes, buffer) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  for (const [name, count, offset] of [['from', 3, 0], ['to', 3, 3], ['colour', 4, 6], ['look', 2, 10]]) {
    const place = strokes.input(name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, count, gl.FLOAT, false, 4 * LINE_NUMBERS, 4 * offset);
    gl.vertexAttribDivisor(place, 1);
  }
  gl.bindVertexArray(null);
  return array;
}
