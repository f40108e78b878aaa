import java.awt.image.BufferedImage;
import java.io.ByteArrayOutputStream;
import java.nio.ByteBuffer;
import java.nio.file.Files;
import java.nio.file.Paths;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import javax.imageio.ImageIO;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMDataOutputStream;
import lcm.spy.SpyPlugin;
import lcm.util.ClassDiscoverer;
import waymark.image_metadata_t;
import waymark.image_t;
import waymark.spy.ImageDecoder;

/**
 * Looks for types and plugins in CLASSPATH the way lcm-spy does, and decodes
 * images without a screen. Argument: tests/lcmtypes/fingerprints.txt.
 */
public final class SpyPluginTest {
  private static int numFailed;

  public static void main(String[] arguments) throws Exception {
    System.setProperty("java.awt.headless", "true");
    Map<String, Long> types = new HashMap<>();
    List<Class<?>> plugins = new ArrayList<>();
    ClassDiscoverer.findClasses(System.getenv("CLASSPATH"), (jar, type) -> {
      try {
        types.put(
            type.getName(), type.getField("LCM_FINGERPRINT").getLong(null));
      } catch (ReflectiveOperationException e) {
        // Not a message type.
      }
      // lcm-spy sees an interface only where the class names it directly.
      if (Arrays.asList(type.getInterfaces()).contains(SpyPlugin.class)
          && type.getName().startsWith("waymark.")) {
        plugins.add(type);
      }
    });
    testFingerprints(types, arguments[0]);
    testPlugin(plugins);
    testPixels();
    testJpeg();
    testMetadata();
    testBadImages();
    System.out.println(numFailed == 0 ? "passed" : numFailed + " failed");
    System.exit(numFailed == 0 ? 0 : 1);
  }

  private static void expect(boolean condition, String what) {
    if (!condition) {
      System.out.println("FAILED: " + what);
      numFailed++;
    }
  }

  private static void testFingerprints(Map<String, Long> types, String path)
      throws Exception {
    int numTypes = 0;
    for (String line : Files.readAllLines(Paths.get(path))) {
      String[] words = line.split("#", 2)[0].trim().split("\\s+");
      if (words.length != 2) {
        continue;
      }
      numTypes++;
      Long found = types.get(words[0]);
      expect(found != null && found == Long.parseUnsignedLong(words[1], 16),
          words[0] + " has fingerprint "
              + (found == null ? "none" : Long.toHexString(found)));
    }
    expect(numTypes > 20, numTypes + " stored types");
  }

  private static void testPlugin(List<Class<?>> plugins) throws Exception {
    expect(plugins.size() == 1, "one plugin found, not " + plugins);
    SpyPlugin plugin =
        (SpyPlugin) plugins.get(0).getDeclaredConstructor().newInstance();
    expect(plugin.canHandle(0x14739ffe13d5f5f0L), "handles bot_core.image_t");
    expect(!plugin.canHandle(0x2e16efb052b0105eL), "handles images only");
    // lcm-spy asks so for the action's name.
    expect(plugin.getAction(null, null) != null, "tolerates nulls");
    plugin.getAction(null, null).actionPerformed(null);
  }

  private static image_t image(
      int width, int height, int stride, int format, int... data) {
    image_t image = new image_t();
    image.width = width;
    image.height = height;
    image.row_stride = stride;
    image.pixelformat = format;
    image.size = data.length;
    image.data = new byte[data.length];
    for (int i = 0; i < data.length; i++) {
      image.data[i] = (byte) data[i];
    }
    image.metadata = new image_metadata_t[0];
    return image;
  }

  /** Through the wire, as the viewer gets it. */
  private static image_t sent(image_t image) throws Exception {
    LCMDataOutputStream out = new LCMDataOutputStream();
    image.encode(out);
    return new image_t(new LCMDataInputStream(out.toByteArray()));
  }

  private static void testPixels() throws Exception {
    // Two rows of one pixel, each followed by padding that must not show.
    BufferedImage gray = ImageDecoder.decode(
        sent(image(1, 2, 3, image_t.PIXEL_FORMAT_GRAY, 200, 1, 1, 100)));
    expect((gray.getRaster().getSample(0, 0, 0)) == 200, "gray, first row");
    expect((gray.getRaster().getSample(0, 1, 0)) == 100, "gray, second row");
    BufferedImage rgb = ImageDecoder.decode(
        sent(image(1, 1, 3, image_t.PIXEL_FORMAT_RGB, 0xc0, 0x40, 0x20)));
    expect(rgb.getRGB(0, 0) == 0xffc04020, "RGB order");
    BufferedImage bgr = ImageDecoder.decode(
        sent(image(1, 1, 3, image_t.PIXEL_FORMAT_BGR, 0xc0, 0x40, 0x20)));
    expect(bgr.getRGB(0, 0) == 0xff2040c0, "BGR order");
  }

  private static byte[] jpegFile() throws Exception {
    BufferedImage red = new BufferedImage(16, 8, BufferedImage.TYPE_INT_RGB);
    for (int i = 0; i < 16 * 8; i++) {
      red.setRGB(i % 16, i / 16, 0xff0000);
    }
    ByteArrayOutputStream file = new ByteArrayOutputStream();
    ImageIO.write(red, "jpg", file);
    return file.toByteArray();
  }

  private static void testJpeg() throws Exception {
    image_t message = image(16, 8, 0, image_t.PIXEL_FORMAT_MJPEG);
    message.data = jpegFile();
    message.size = message.data.length;
    BufferedImage decoded = ImageDecoder.decode(sent(message));
    expect(decoded.getWidth() == 16 && decoded.getHeight() == 8, "JPEG size");
    int pixel = decoded.getRGB(8, 4);
    // JPEG of one colour keeps it within a few grey levels.
    expect((pixel >> 16 & 255) > 245 && (pixel & 255) < 10, "JPEG colour");
  }

  private static void testMetadata() throws Exception {
    image_t message = image(1, 1, 1, image_t.PIXEL_FORMAT_GRAY, 5);
    expect(ImageDecoder.sequence(message) == -1, "no sequence number");
    expect(Double.isNaN(ImageDecoder.angle(message, "pan")), "no pan");
    message.nmetadata = 2;
    message.metadata = new image_metadata_t[] {
        entry("seq", ByteBuffer.allocate(8).putLong(258).array()),
        entry("pan", ByteBuffer.allocate(8).putDouble(0.25).array())};
    image_t received = sent(message);
    expect(ImageDecoder.sequence(received) == 258, "sequence number");
    expect(ImageDecoder.angle(received, "pan") == 0.25, "pan");
  }

  private static image_metadata_t entry(String key, byte[] value) {
    image_metadata_t entry = new image_metadata_t();
    entry.key = key;
    entry.n = value.length;
    entry.value = value;
    return entry;
  }

  private static void refuses(image_t image, String part) {
    try {
      ImageDecoder.decode(image);
      expect(false, "refuses: " + part);
    } catch (ImageDecoder.BadImage e) {
      expect(e.getMessage().contains(part), e.getMessage() + " says " + part);
    }
  }

  private static void testBadImages() throws Exception {
    int gray = image_t.PIXEL_FORMAT_GRAY;
    refuses(image(0, 1, 1, gray), "size 0 x 1");
    refuses(image(1, -1, 1, gray), "size 1 x -1");
    refuses(image(1 << 15, 1, 1 << 15, gray), "size 32768");
    refuses(image(16384, 16384, 16384, gray), "size 16384 x 16384");
    refuses(image(2, 1, 1, gray, 1, 2), "row_stride 1");
    refuses(image(2, 2, 2, gray, 1, 2, 3), "3 bytes of data");
    // height * stride beyond 2^31 must not wrap round.
    refuses(image(2, 16384, 1 << 30, gray, 1, 2), "2 bytes of data");
    refuses(image(2, 1, 2, 0, 1, 2), "pixel format 0");
    refuses(image(2, 1, 0, image_t.PIXEL_FORMAT_MJPEG, 1, 2), "no JPEG");
    refuses(image(2, 1, 0, image_t.PIXEL_FORMAT_MJPEG), "no JPEG");
    byte[] whole = jpegFile();
    image_t cut = image(16, 8, 0, image_t.PIXEL_FORMAT_MJPEG);
    for (int size = 0; size < whole.length; size++) {
      cut.data = Arrays.copyOf(whole, size);
      cut.size = size;
      try {
        ImageDecoder.decode(cut);  // The last bytes may be missing.
      } catch (ImageDecoder.BadImage e) {
        expect(!e.getMessage().isEmpty(), "says why");
      }
    }
  }
}
