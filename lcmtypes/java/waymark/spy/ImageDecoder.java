package waymark.spy;

import java.awt.image.BufferedImage;
import java.awt.image.DataBufferByte;
import java.io.ByteArrayInputStream;
import java.io.IOException;
import java.nio.ByteBuffer;
import java.util.Iterator;
import javax.imageio.ImageIO;
import javax.imageio.ImageReader;
import javax.imageio.stream.ImageInputStream;
import waymark.image_metadata_t;
import waymark.image_t;

/** From an image message to pixels. No state, no screen. */
public final class ImageDecoder {
  /** What is wrong with an image, in words for the person who looks at it. */
  public static final class BadImage extends Exception {
    private static final long serialVersionUID = 1;

    BadImage(String reason) {
      super(reason);
    }
  }

  // Also bounds what a small, hostile JPEG can unfold to: 16 Mpx, 48 MB.
  private static final int MAX_SIDE_PX = 1 << 14;
  private static final int MAX_AREA_PX = 1 << 24;

  static {
    // ImageIO would otherwise write each image to a temporary file first.
    ImageIO.setUseCache(false);
  }

  private ImageDecoder() {}

  /**
   * Pixels of a GRAY, RGB, BGR or MJPEG image.
   *
   * @throws BadImage where the format is another or the data does not fit it.
   */
  public static BufferedImage decode(image_t image) throws BadImage {
    try {
      switch (image.pixelformat) {
        case image_t.PIXEL_FORMAT_GRAY:
          return raw(image, BufferedImage.TYPE_BYTE_GRAY, 1, false);
        case image_t.PIXEL_FORMAT_RGB:
          return raw(image, BufferedImage.TYPE_3BYTE_BGR, 3, true);
        case image_t.PIXEL_FORMAT_BGR:
          return raw(image, BufferedImage.TYPE_3BYTE_BGR, 3, false);
        case image_t.PIXEL_FORMAT_MJPEG:
          return jpeg(image.data);
        default:
          throw new BadImage("pixel format " + formatName(image.pixelformat)
              + " (known here: GRAY, RGB, BGR, MJPEG)");
      }
    } catch (IOException | RuntimeException e) {
      // ImageIO throws both, also IndexOutOfBounds, on broken files.
      throw new BadImage("not decodable: " + e);
    }
  }

  public static String formatName(int pixelFormat) {
    switch (pixelFormat) {
      case image_t.PIXEL_FORMAT_GRAY:
        return "GRAY";
      case image_t.PIXEL_FORMAT_RGB:
        return "RGB";
      case image_t.PIXEL_FORMAT_BGR:
        return "BGR";
      case image_t.PIXEL_FORMAT_MJPEG:
        return "MJPEG";
      default:
        return Integer.toString(pixelFormat);
    }
  }

  /** Sequence number in the metadata; -1 where there is none. */
  public static long sequence(image_t image) {
    byte[] value = metadata(image, "seq");
    return value == null ? -1 : ByteBuffer.wrap(value).getLong();
  }

  /** Metadata "pan" or "tilt", rad; NaN where there is none. */
  public static double angle(image_t image, String key) {
    byte[] value = metadata(image, key);
    return value == null ? Double.NaN : ByteBuffer.wrap(value).getDouble();
  }

  private static byte[] metadata(image_t image, String key) {
    for (image_metadata_t item : image.metadata) {
      if (item.key.equals(key) && item.value.length == 8) {
        return item.value;
      }
    }
    return null;
  }

  private static BufferedImage raw(
      image_t image, int type, int channels, boolean swap) throws BadImage {
    checkSize(image.width, image.height);
    long rowBytes = (long) image.width * channels;
    if (image.row_stride < rowBytes) {
      throw new BadImage("row_stride " + image.row_stride + " is less than the "
          + rowBytes + " bytes of a row");
    }
    long needed = (long) image.row_stride * (image.height - 1) + rowBytes;
    if (image.data.length < needed) {
      throw new BadImage(image.data.length + " bytes of data; " + image.width
          + " x " + image.height + " needs " + needed);
    }
    BufferedImage result = new BufferedImage(image.width, image.height, type);
    byte[] pixels =
        ((DataBufferByte) result.getRaster().getDataBuffer()).getData();
    int width = (int) rowBytes;
    for (int y = 0; y < image.height; y++) {
      System.arraycopy(
          image.data, y * image.row_stride, pixels, y * width, width);
    }
    if (swap) {
      for (int i = 0; i + 2 < pixels.length; i += 3) {
        byte first = pixels[i];
        pixels[i] = pixels[i + 2];
        pixels[i + 2] = first;
      }
    }
    return result;
  }

  private static BufferedImage jpeg(byte[] data)
      throws BadImage, IOException {
    ByteArrayInputStream bytes = new ByteArrayInputStream(data);
    try (ImageInputStream input = ImageIO.createImageInputStream(bytes)) {
      Iterator<ImageReader> readers = ImageIO.getImageReaders(input);
      if (!readers.hasNext()) {
        throw new BadImage(data.length + " bytes that are no JPEG file");
      }
      ImageReader reader = readers.next();
      try {
        reader.setInput(input, true, true);
        checkSize(reader.getWidth(0), reader.getHeight(0));
        return reader.read(0);
      } finally {
        reader.dispose();
      }
    }
  }

  private static void checkSize(int width, int height) throws BadImage {
    if (width < 1 || height < 1 || width > MAX_SIDE_PX || height > MAX_SIDE_PX
        || (long) width * height > MAX_AREA_PX) {
      throw new BadImage("size " + width + " x " + height
          + " px (allowed: 1 to " + MAX_SIDE_PX + " a side, " + MAX_AREA_PX + " in all)");
    }
  }
}
