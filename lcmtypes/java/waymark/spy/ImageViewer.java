package waymark.spy;

import java.awt.BorderLayout;
import java.awt.Color;
import java.awt.Dimension;
import java.awt.Font;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.GridLayout;
import java.awt.RenderingHints;
import java.awt.Window;
import java.awt.event.WindowAdapter;
import java.awt.event.WindowEvent;
import java.awt.image.BufferedImage;
import java.beans.PropertyVetoException;
import java.util.concurrent.atomic.AtomicLong;
import java.util.concurrent.atomic.AtomicReference;
import javax.swing.JDesktopPane;
import javax.swing.JInternalFrame;
import javax.swing.JLabel;
import javax.swing.JPanel;
import javax.swing.SwingUtilities;
import javax.swing.event.InternalFrameAdapter;
import javax.swing.event.InternalFrameEvent;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import waymark.image_t;

/**
 * A window with the newest image of one channel, scaled to fit, and two lines
 * that say what it is. LCM's thread only takes messages in, a thread of the
 * window decodes the newest one, Swing's thread paints: a slow decoder skips
 * images and holds up nobody.
 */
final class ImageViewer extends JPanel implements LCMSubscriber {
  private static final long serialVersionUID = 1;
  // Weight of the newest interval in the shown rate: settles in about 20.
  private static final double RATE_GAIN = 0.1;

  private final JLabel what = new JLabel(" no image yet");
  private final JLabel when = new JLabel(" ");
  private final Canvas canvas = new Canvas();
  private final transient AtomicReference<image_t> newest =
      new AtomicReference<>();
  private final transient Object wake = new Object();
  private volatile boolean closed;

  private final AtomicLong numBad = new AtomicLong();
  // Written by LCM's thread alone.
  private volatile long numLost;
  private volatile double intervalS;
  private long lastNanos;
  private long lastSequence = -1;

  /** lcm-spy gives each viewer a window with an empty desktop: fill it. */
  static void open(JDesktopPane desktop, String channel) {
    ImageViewer viewer = new ImageViewer();
    JInternalFrame frame =
        new JInternalFrame(channel + " image", true, true, true, true);
    frame.add(viewer);
    frame.setSize(480, 380);
    desktop.add(frame);
    frame.setVisible(true);
    try {
      frame.setMaximum(true);
    } catch (PropertyVetoException e) {
      // Stays at its size.
    }
    Runnable close = () -> {
      LCM.getSingleton().unsubscribe(channel, viewer);
      viewer.close();
    };
    frame.addInternalFrameListener(new InternalFrameAdapter() {
      @Override
      public void internalFrameClosed(InternalFrameEvent event) {
        close.run();
      }
    });
    // lcm-spy shows that window after this call.
    SwingUtilities.invokeLater(() -> {
      Window window = SwingUtilities.getWindowAncestor(desktop);
      if (window != null) {
        window.setSize(680, 590);
        window.addWindowListener(new WindowAdapter() {
          @Override
          public void windowClosing(WindowEvent event) {
            close.run();
          }
        });
      }
    });
    Thread decoder = new Thread(viewer::decodeUntilClosed, "image " + channel);
    decoder.setDaemon(true);
    decoder.start();
    LCM.getSingleton().subscribe(channel, viewer);
  }

  private ImageViewer() {
    super(new BorderLayout());
    canvas.setPreferredSize(new Dimension(640, 480));
    add(canvas, BorderLayout.CENTER);
    JPanel lines = new JPanel(new GridLayout(2, 1));
    for (JLabel label : new JLabel[] {what, when}) {
      label.setFont(new Font(Font.MONOSPACED, Font.PLAIN, 12));
      lines.add(label);
    }
    add(lines, BorderLayout.SOUTH);
  }

  @Override
  public void messageReceived(LCM lcm, String channel, LCMDataInputStream in) {
    image_t image;
    try {
      image = new image_t(in);
    } catch (Exception | OutOfMemoryError e) {
      // Another type on this channel, cut short, or an impossible length.
      numBad.incrementAndGet();
      return;
    }
    long now = System.nanoTime();
    if (lastNanos != 0) {
      double step = (now - lastNanos) * 1e-9;
      intervalS = intervalS == 0 ? step
                                 : intervalS + RATE_GAIN * (step - intervalS);
    }
    lastNanos = now;
    long sequence = ImageDecoder.sequence(image);
    if (sequence > lastSequence && lastSequence >= 0) {
      numLost = numLost + sequence - lastSequence - 1;
    }
    lastSequence = sequence;
    newest.set(image);
    synchronized (wake) {
      wake.notifyAll();
    }
  }

  private void close() {
    closed = true;
    synchronized (wake) {
      wake.notifyAll();
    }
  }

  private void decodeUntilClosed() {
    while (!closed) {
      image_t image = newest.getAndSet(null);
      if (image == null) {
        try {
          synchronized (wake) {
            // Bounded, so that a wake-up between the look and here costs
            // little.
            wake.wait(100);
          }
        } catch (InterruptedException e) {
          return;
        }
        continue;
      }
      String size = String.format("%d x %d %s  %.1f kB%s", image.width,
          image.height, ImageDecoder.formatName(image.pixelformat),
          image.size / 1000.0, angles(image));
      BufferedImage pixels = null;
      String reason = "";
      try {
        pixels = ImageDecoder.decode(image);
      } catch (ImageDecoder.BadImage | OutOfMemoryError e) {
        numBad.incrementAndGet();
        reason = "  bad image: " + e.getMessage();
      }
      BufferedImage shown = pixels;
      String first = " " + size + reason;
      String second = " " + timing(image);
      SwingUtilities.invokeLater(() -> show(shown, first, second));
    }
  }

  private void show(BufferedImage pixels, String first, String second) {
    what.setText(first);
    what.setToolTipText(first);
    when.setText(second);
    canvas.image = pixels;
    canvas.repaint();
  }

  private static String angles(image_t image) {
    StringBuilder text = new StringBuilder();
    for (String key : new String[] {"pan", "tilt"}) {
      double angle = ImageDecoder.angle(image, key);
      if (!Double.isNaN(angle)) {
        text.append(
            String.format("  %s %.1f\u00b0", key, Math.toDegrees(angle)));
      }
    }
    return text.toString();
  }

  private String timing(image_t image) {
    StringBuilder text = new StringBuilder();
    text.append(intervalS > 0 ? String.format("%.1f Hz  ", 1 / intervalS) : "");
    text.append("utime ").append(image.utime);
    long sequence = ImageDecoder.sequence(image);
    if (sequence >= 0) {
      text.append("  seq ").append(sequence).append("  lost ").append(numLost);
    }
    if (numBad.get() > 0) {
      text.append("  bad ").append(numBad.get());
    }
    return text.toString();
  }

  /** Paints the image as large as fits, its shape kept. */
  private static final class Canvas extends JPanel {
    private static final long serialVersionUID = 1;
    private transient BufferedImage image;

    @Override
    protected void paintComponent(Graphics graphics) {
      graphics.setColor(Color.DARK_GRAY);
      graphics.fillRect(0, 0, getWidth(), getHeight());
      if (image == null) {
        return;
      }
      double scale = Math.min(getWidth() / (double) image.getWidth(),
          getHeight() / (double) image.getHeight());
      int width = Math.max(1, (int) Math.round(scale * image.getWidth()));
      int height = Math.max(1, (int) Math.round(scale * image.getHeight()));
      // Enlarged pixels stay pixels; shrunk ones are smoothed.
      ((Graphics2D) graphics)
          .setRenderingHint(RenderingHints.KEY_INTERPOLATION,
              scale > 1 ? RenderingHints.VALUE_INTERPOLATION_NEAREST_NEIGHBOR
                        : RenderingHints.VALUE_INTERPOLATION_BILINEAR);
      graphics.drawImage(image, (getWidth() - width) / 2,
          (getHeight() - height) / 2, width, height, null);
    }
  }
}
