// A ground that shows nothing but soft shadows: the sheet and the bodies as seen from below, darker where
// they are nearer, and blurred. As the contact shadows in the examples of three.js.

import {
  Group,
  Mesh,
  MeshBasicMaterial,
  MeshDepthMaterial,
  OrthographicCamera,
  PlaneGeometry,
  ShaderMaterial,
  Vector3,
  WebGLRenderTarget,
} from "three";
import { HorizontalBlurShader } from "three/addons/shaders/HorizontalBlurShader.js";
import { VerticalBlurShader } from "three/addons/shaders/VerticalBlurShader.js";

/** Half the side of the ground on the stage. */
const REACH = 2;
/** Up to which height what is above it darkens the ground, on the stage. */
const HEIGHT = 0.6;
const PIXELS = 512;
/** How far shadows are blurred, in two rounds: in steps of a 256th of the side. */
const BLURS = [3.5, 1.4];
/** How dark a shadow is. */
const SHADE = 0.45;
/** The layer of what casts shadows. */
const CASTERS = 1;

/** Makes an object cast a shadow on the ground. */
export const castOnGround = (object) => object.layers.enable(CASTERS);

export class Ground {
  /** A ground at a place of the stage, whose normal is `up`. */
  constructor(place, up) {
    const plane = new PlaneGeometry(2 * REACH, 2 * REACH).rotateX(Math.PI / 2);
    [this.target, this.other] = [0, 1].map(() => new WebGLRenderTarget(PIXELS, PIXELS));
    this.shadow = new Mesh(
      plane,
      new MeshBasicMaterial({ map: this.target.texture, opacity: SHADE, transparent: true, depthWrite: false }),
    );
    // The picture from below is mirrored; so turned it is seen from above.
    this.shadow.scale.y = -1;
    this.shadow.renderOrder = -1;
    this.screen = new Mesh(plane);
    this.screen.visible = false;
    this.camera = new OrthographicCamera(-REACH, REACH, REACH, -REACH, 0, HEIGHT);
    this.camera.rotation.x = Math.PI / 2;
    this.camera.layers.set(CASTERS);
    this.blurred = new OrthographicCamera(-REACH, REACH, REACH, -REACH, 0, HEIGHT);
    this.blurred.rotation.x = Math.PI / 2;
    this.object = new Group();
    this.object.position.copy(place);
    this.object.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), up);
    this.object.add(this.shadow, this.screen, this.camera, this.blurred);
    this.depth = new MeshDepthMaterial({ depthTest: false, depthWrite: false });
    this.depth.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace(
        /gl_FragColor = vec4\( vec3\( 1\.0 - fragCoordZ \), opacity \);/,
        "gl_FragColor = vec4( vec3( 0.0 ), 1.0 - fragCoordZ );",
      );
    };
    const blur = (shader) => Object.assign(new ShaderMaterial(shader), { depthTest: false });
    this.rounds = [
      { material: blur(HorizontalBlurShader), step: "h" },
      { material: blur(VerticalBlurShader), step: "v" },
    ];
    this.isStale = true;
  }

  /** Draws the shadows anew, if what casts them has changed. */
  update(renderer, scene) {
    if (!this.isStale) return;
    this.isStale = false;
    const alpha = renderer.getClearAlpha();
    renderer.setClearAlpha(0);
    this.shadow.visible = false;
    scene.overrideMaterial = this.depth;
    renderer.setRenderTarget(this.target);
    renderer.clear();
    renderer.render(scene, this.camera);
    scene.overrideMaterial = null;
    this.screen.visible = true;
    for (const amount of BLURS) {
      let [from, to] = [this.target, this.other];
      for (const { material, step } of this.rounds) {
        material.uniforms.tDiffuse.value = from.texture;
        material.uniforms[step].value = amount / 256;
        this.screen.material = material;
        renderer.setRenderTarget(to);
        renderer.clear();
        renderer.render(this.screen, this.blurred);
        [from, to] = [to, from];
      }
    }
    renderer.setRenderTarget(null);
    renderer.setClearAlpha(alpha);
    this.screen.visible = false;
    this.shadow.visible = true;
  }
}
