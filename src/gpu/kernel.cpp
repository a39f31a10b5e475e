#include "gpu/kernel.hpp"

#include "core/resources.hpp"
#include "gpu/context_native.hpp"
#include "gpu/gl.hpp"

#include <fmt/format.h>

#include <cassert>
#include <utility>

namespace apeiron::gpu {
namespace {

struct ImageFormat {
    const char* layout;
    const char* type;
    GLenum internal;
};

ImageFormat imageFormat(PixelFormat format) {
    switch (format) {
    case PixelFormat::R32F:
        return {"r32f", "image2D", GL_R32F};
    case PixelFormat::RG32F:
        return {"rg32f", "image2D", GL_RG32F};
    case PixelFormat::RGBA32F:
        return {"rgba32f", "image2D", GL_RGBA32F};
    case PixelFormat::RGBA16F:
        return {"rgba16f", "image2D", GL_RGBA16F};
    case PixelFormat::RGBA8:
        return {"rgba8", "image2D", GL_RGBA8};
    case PixelFormat::R32I:
        return {"r32i", "iimage2D", GL_R32I};
    case PixelFormat::RG32I:
        return {"rg32i", "iimage2D", GL_RG32I};
    }
    assert(false);
    return {};
}

/// A shader object that is deleted when it goes out of scope.
class Shader {
  public:
    Shader(GLenum type, const std::string& text) : name_(glCreateShader(type)) {
        const char* data = text.c_str();
        glShaderSource(name_, 1, &data, nullptr);
        glCompileShader(name_);
    }
    ~Shader() { glDeleteShader(name_); }
    Shader(const Shader&) = delete;
    Shader& operator=(const Shader&) = delete;

    GLuint name() const { return name_; }
    bool compiled() const {
        GLint status = 0;
        glGetShaderiv(name_, GL_COMPILE_STATUS, &status);
        return status == GL_TRUE;
    }
    std::string log() const {
        GLint length = 0;
        glGetShaderiv(name_, GL_INFO_LOG_LENGTH, &length);
        std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
        glGetShaderInfoLog(name_, length, &length, log.data());
        log.resize(static_cast<std::size_t>(std::max(length, 0)));
        return log;
    }

  private:
    GLuint name_;
};

std::string programLog(GLuint program) {
    GLint length = 0;
    glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    glGetProgramInfoLog(program, length, &length, log.data());
    log.resize(static_cast<std::size_t>(std::max(length, 0)));
    return log;
}

constexpr const char* kVertexText = R"(#version 300 es
void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";

} // namespace

std::string_view toString(Stage stage) {
    return stage == Stage::Compute ? "compute" : "fragment";
}

std::string stageText(const ShaderSource& source, Stage stage, const std::vector<PixelFormat>& formats,
                      std::string_view version) {
    const auto outputs = source.outputs();
    assert(outputs.size() == formats.size());
    std::string text = fmt::format("#version {}\n", version);
    text += "precision highp float;\nprecision highp int;\n"
            "precision highp sampler2D;\nprecision highp isampler2D;\nprecision highp sampler3D;\n"
            "precision highp usampler3D;\n";
    text += fmt::format("#define APEIRON_OUTPUTS {}\n", outputs.size());
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const ImageFormat format = imageFormat(formats[i]);
        text +=
            fmt::format("#define APEIRON_TYPE_{0} {1}\n#define APEIRON_FORMAT_{0} {2}\n#define APEIRON_IMAGE_{0} {3}\n",
                        i, outputs[i].type, format.layout, format.type);
    }
    text += "uniform ivec4 apeiron_map;    // origin and offset of the pixel map\n"
            "uniform int apeiron_stride;\n"
            "uniform ivec2 apeiron_size;   // of the picture [px]\n";
    text += "#line 1 0\n"; // ShaderSource knows where each of its lines came from
    text += source.text();
    const std::string_view epilogue = stage == Stage::Compute ? "gpu/glsl/compute.glsl" : "gpu/glsl/fragment.glsl";
    text += findResource(epilogue).value().text;
    return text;
}

Kernel::Kernel(const Context& context, const std::string& label, const ShaderSource& source, Stage stage,
               std::vector<PixelFormat> formats)
    : stage_(stage), formats_(std::move(formats)), bindings_(source.bindings()) {
    const Capabilities& c = context.capabilities();
    if (stage == Stage::Compute && !c.compute) {
        throw Error(ErrorKind::BadInput, fmt::format("{} has no compute shaders", c.renderer), "--stage",
                    "use the fragment stage");
    }
    if (source.outputs().size() != formats_.size() || formats_.empty() || formats_.size() > 4) {
        throw Error(
            ErrorKind::BadInput,
            fmt::format("kernel_main must have {} 'out' parameters, has {}", formats_.size(), source.outputs().size()),
            label);
    }
    const std::string_view version = stage == Stage::Fragment ? "300 es" : (c.es ? "310 es" : "430");
    program_ = glCreateProgram();
    const auto fail = [&](const std::string& log) -> Error {
        glDeleteProgram(program_);
        nativeProblem(); // debug contexts keep the same complaint for the next check()
        const bool user = source.blamesUser(log);
        return Error(user ? ErrorKind::BadInput : ErrorKind::Gpu,
                     user ? source.mapLog(log)
                          : fmt::format("kernel '{}' does not compile: {}", label, source.mapLog(log)));
    };
    const Shader main(stage == Stage::Compute ? GL_COMPUTE_SHADER : GL_FRAGMENT_SHADER,
                      stageText(source, stage, formats_, version));
    if (!main.compiled()) throw fail(main.log());
    glAttachShader(program_, main.name());
    if (stage == Stage::Fragment) {
        const Shader vertex(GL_VERTEX_SHADER, kVertexText);
        glAttachShader(program_, vertex.name());
        glLinkProgram(program_);
        glDetachShader(program_, vertex.name());
        glGenVertexArrays(1, &vertexArray_);
    } else {
        glLinkProgram(program_);
    }
    glDetachShader(program_, main.name());
    GLint linked = 0;
    glGetProgramiv(program_, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) throw fail(programLog(program_));
#ifndef __EMSCRIPTEN__
    if (!c.es) glObjectLabel(GL_PROGRAM, program_, static_cast<GLsizei>(label.size()), label.data());
#endif
    context.check(("compiling " + label).c_str());
}

Kernel::~Kernel() {
    if (program_ != 0) glDeleteProgram(program_);
    if (vertexArray_ != 0) glDeleteVertexArrays(1, &vertexArray_);
}

Kernel::Kernel(Kernel&& other) noexcept
    : program_(std::exchange(other.program_, 0)), vertexArray_(std::exchange(other.vertexArray_, 0)),
      stage_(other.stage_), formats_(std::move(other.formats_)), bindings_(std::move(other.bindings_)),
      locations_(std::move(other.locations_)), samplers_(std::move(other.samplers_)) {}

Kernel& Kernel::operator=(Kernel&& other) noexcept {
    std::swap(program_, other.program_);
    std::swap(vertexArray_, other.vertexArray_);
    std::swap(stage_, other.stage_);
    std::swap(formats_, other.formats_);
    std::swap(bindings_, other.bindings_);
    std::swap(locations_, other.locations_);
    std::swap(samplers_, other.samplers_);
    return *this;
}

int Kernel::location(std::string_view name) {
    glUseProgram(program_);
    const std::string key(name);
    const auto [it, isNew] = locations_.try_emplace(key, -1);
    if (isNew) it->second = glGetUniformLocation(program_, key.c_str());
    return it->second;
}

void Kernel::set(std::string_view name, bool value) {
    set(name, value ? 1 : 0);
}
void Kernel::set(std::string_view name, int value) {
    glUniform1i(location(name), value);
}
void Kernel::set(std::string_view name, std::uint32_t value) {
    glUniform1ui(location(name), value);
}
void Kernel::set(std::string_view name, float value) {
    glUniform1f(location(name), value);
}
void Kernel::set(std::string_view name, glm::ivec2 value) {
    glUniform2i(location(name), value.x, value.y);
}
void Kernel::set(std::string_view name, glm::vec2 value) {
    glUniform2f(location(name), value.x, value.y);
}
void Kernel::set(std::string_view name, glm::vec3 value) {
    glUniform3f(location(name), value.x, value.y, value.z);
}
void Kernel::set(std::string_view name, glm::vec4 value) {
    glUniform4f(location(name), value.x, value.y, value.z, value.w);
}
void Kernel::set(std::string_view name, const glm::mat3& value) {
    glUniformMatrix3fv(location(name), 1, GL_FALSE, &value[0].x);
}
void Kernel::set(std::string_view name, std::span<const float> values) {
    glUniform1fv(location(name), static_cast<GLsizei>(values.size()), values.data());
}
void Kernel::set(std::string_view name, std::span<const int> values) {
    glUniform1iv(location(name), static_cast<GLsizei>(values.size()), values.data());
}
void Kernel::set(std::string_view name, std::span<const glm::vec3> values) {
    glUniform3fv(location(name), static_cast<GLsizei>(values.size()), &values.data()->x);
}
void Kernel::set(std::string_view name, std::span<const glm::vec4> values) {
    glUniform4fv(location(name), static_cast<GLsizei>(values.size()), &values.data()->x);
}

void Kernel::set(std::string_view name, const Texture& texture) {
    setSampler(name, GL_TEXTURE_2D, texture.name());
}
void Kernel::set(std::string_view name, const Texture3D& texture) {
    setSampler(name, GL_TEXTURE_3D, texture.name());
}

void Kernel::setSampler(std::string_view name, unsigned target, unsigned texture) {
    const int where = location(name);
    if (where < 0) return;
    const auto [it, isNew] = samplers_.try_emplace(where, Sampler{static_cast<int>(samplers_.size()), target, texture});
    it->second.texture = texture;
    if (isNew) glUniform1i(where, it->second.unit);
}

void Kernel::setParameters(std::string_view slot, const parameter::Node& node) {
    for (const UniformBinding& binding : bindings_) {
        if (binding.slot != slot) continue;
        const parameter::Value& value = node.value(binding.parameter);
        switch (node.schema().at(binding.parameter).type) {
        case parameter::Type::Bool:
            set(binding.uniform, std::get<bool>(value));
            break;
        case parameter::Type::Int:
            set(binding.uniform, static_cast<int>(std::get<std::int64_t>(value)));
            break;
        case parameter::Type::Float:
            set(binding.uniform, static_cast<float>(std::get<double>(value)));
            break;
        case parameter::Type::Vec2:
            set(binding.uniform, glm::vec2(std::get<glm::dvec2>(value)));
            break;
        case parameter::Type::Vec3:
            set(binding.uniform, glm::vec3(std::get<glm::dvec3>(value)));
            break;
        case parameter::Type::Vec4:
            set(binding.uniform, glm::vec4(std::get<glm::dvec4>(value)));
            break;
        case parameter::Type::Choice:
            set(binding.uniform, node.choice(binding.parameter));
            break;
        default:
            assert(false);
        }
    }
}

void Kernel::run(const Targets& targets, const Region& region, glm::ivec2 size, const PixelMap& map) {
    if (region.size.x <= 0 || region.size.y <= 0) return;
    glUseProgram(program_);
    glUniform4i(location("apeiron_map"), map.origin.x, map.origin.y, map.offset.x, map.offset.y);
    set("apeiron_stride", map.stride);
    set("apeiron_size", size);
    for (const auto& [where, sampler] : samplers_) {
        glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + sampler.unit));
        glBindTexture(sampler.target, sampler.texture);
    }
    glActiveTexture(GL_TEXTURE0);
#ifndef __EMSCRIPTEN__
    if (stage_ == Stage::Compute) {
        assert(targets.textures().size() == formats_.size());
        for (std::size_t i = 0; i < formats_.size(); ++i) {
            glBindImageTexture(static_cast<GLuint>(i), targets.textures()[i]->name(), 0, GL_FALSE, 0, GL_WRITE_ONLY,
                               imageFormat(formats_[i]).internal);
        }
        glUniform4i(location("apeiron_region"), region.origin.x, region.origin.y, region.size.x, region.size.y);
        glDispatchCompute((static_cast<GLuint>(region.size.x) + 7) / 8, (static_cast<GLuint>(region.size.y) + 7) / 8,
                          1);
        glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                        GL_TEXTURE_UPDATE_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
        return;
    }
#endif
    glBindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer());
    glViewport(region.origin.x, region.origin.y, region.size.x, region.size.y);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glBindVertexArray(vertexArray_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
}

void Kernel::run(const Targets& targets) {
    run(targets, {{0, 0}, targets.size()}, targets.size());
}

} // namespace apeiron::gpu
